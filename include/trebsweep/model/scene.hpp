#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string_view>

namespace trebsweep {

/// The beam's moment of inertia: that of a slender rod as in the paper (18), that of the
/// rectangular prism, or zero (as in the paper's Appendix C, where only the beam's weight acts).
enum class BeamInertia { slender, prism, none };

/// In the order of BeamInertia.
inline constexpr std::array<std::string_view, 3> beam_inertia_names{"slender", "prism", "none"};

/// The physical situation that all designs of a job share, in SI units. Defaults are the paper's.
struct Scene {
  double gravity = 9.8;              ///< g, m/s^2
  double counterweight_mass = 5000;  ///< m1, kg
  double projectile_mass = 100;      ///< m3, kg
  double release_height = 2;    ///< h, m: the counterweight's height above the ground at the start
  double fulcrum_height = 1.5;  ///< h0, m: the fulcrum's height above the ground
  double beam_density = 7850;   ///< rho, kg/m^3
  double beam_side = 0.10;      ///< s, m: side of the beam's square section
  // Another rectangular section, instead of a square: both, or none.
  std::optional<double> beam_width = {};  ///< m: across the plane of the swing
  std::optional<double> beam_depth = {};  ///< m: in the plane of the swing
  BeamInertia beam_inertia = BeamInertia::slender;
  double sling_angle = 0;      ///< phi2(0), rad
  double pivot_viscosity = 0;  ///< N m s/rad: viscous friction torque of the pivot per rate w1
  double pivot_friction = 0;   ///< N m: dry friction torque of the pivot, also at rest
  double sling_mass = 0;       ///< kg, uniform along the sling
  double sling_stiffness = 0;  ///< N/m: tension per stretch; 0: a rigid sling
  double sling_damping = 0;    ///< N s/m: tension per rate of the stretch
  // A measured beam, instead of one computed from density and side: all three, or none.
  std::optional<double> beam_mass = {};    ///< m2, kg
  std::optional<double> beam_centre = {};  ///< r, m: from the fulcrum to the beam's centre of mass,
                                           ///< positive towards the sling
  std::optional<double> beam_moment = {};  ///< Izz, kg m^2: moment of inertia about the fulcrum
  std::optional<double> beam_section_modulus = {};  ///< m^3: at the fulcrum, of a measured beam
  double counterweight_inertia = 0;  ///< kg m^2: of the counterweight about its centre
  // Instead of release_height: one of them, or none.
  std::optional<double> start_angle = {};  ///< phi1(0), rad
  std::optional<double> start_tip_height =
      {};                           ///< m: of the arm's tip above the ground, at phi1(0)
  double counterweight_hanger = 0;  ///< r4, m: link from arm to counterweight; 0: fixed to the arm
  bool trough = false;              ///< whether the projectile starts by sliding in a trough
  double trough_height = 0;         ///< m: of the trough above the ground
  double projectile_diameter = 0;   ///< m: of a projectile that feels drag in flight; 0: no drag
  double drag_coefficient = 0.47;   ///< Cd of the projectile; default: that of a sphere
  double air_density = 1.225;       ///< kg/m^3
  double wind = 0;                  ///< m/s, horizontal, positive in the direction of the throw
};

/// The beam's rectangular section, m; the depth is in the plane of the swing.
struct BeamSection {
  double width, depth;
};

inline BeamSection beam_section(const Scene& scene) {
  if (scene.beam_width) return {*scene.beam_width, *scene.beam_depth};
  return {scene.beam_side, scene.beam_side};
}

/// Bending stress per bending moment at the fulcrum, 1/m^3: the inverse of the section modulus,
/// which is width depth^2/6 for a rectangle (Gere and Goodno, Mechanics of Materials). NaN for a
/// measured beam without one, infinite for a beam without a section.
inline double stress_per_moment(const Scene& scene) {
  if (scene.beam_section_modulus) return 1 / *scene.beam_section_modulus;
  if (scene.beam_mass) return std::numeric_limits<double>::quiet_NaN();
  const auto [width, depth] = beam_section(scene);
  return 6 / (width * depth * depth);
}

/// Whether the bending stress of the beam can be computed.
inline bool has_beam_stress(const Scene& scene) { return std::isfinite(stress_per_moment(scene)); }

/// Effects that change the form of the equations, selected at compile time. Masses and inertias
/// only change constants.
struct Effects {
  bool pivot = false;    ///< friction at the fulcrum, viscous and dry
  bool elastic = false;  ///< an elastic sling
  bool hanger = false;   ///< a counterweight on a hinge
  bool trough = false;   ///< a projectile that starts in a trough

  friend bool operator==(const Effects&, const Effects&) = default;
};

inline Effects effects(const Scene& scene) {
  return {scene.pivot_viscosity > 0 || scene.pivot_friction > 0, scene.sling_stiffness > 0,
          scene.counterweight_hanger > 0, scene.trough};
}

/// The combinations of effects that a scene can have: an elastic sling excludes a hanger and a
/// trough.
inline constexpr std::array<Effects, 10> all_effects{
    {{},
     {.pivot = true},
     {.elastic = true},
     {.pivot = true, .elastic = true},
     {.hanger = true},
     {.pivot = true, .hanger = true},
     {.trough = true},
     {.pivot = true, .trough = true},
     {.hanger = true, .trough = true},
     {.pivot = true, .hanger = true, .trough = true}}};

/// Whether a scene has an effect that dissipates energy.
inline bool is_dissipative(const Scene& scene) {
  return scene.pivot_viscosity > 0 || scene.pivot_friction > 0 || scene.sling_damping > 0;
}

/// Those with a pivot, whose friction may be zero: what does not integrate whole lattices is
/// compiled for these only. Zero friction changes no result, and costs a tenth of the time.
inline constexpr std::array<Effects, 5> general_effects{
    all_effects[1], all_effects[3], all_effects[5], all_effects[7], all_effects[9]};

/// Calls f.operator()<E>() with the one of `sets` that equals some effects. Throws std::logic_error
/// if none does.
template <const auto& sets, std::size_t I = 0, class F>
auto with_one_of(const Effects& effects, F&& f) {
  if (effects == sets[I]) return f.template operator()<sets[I]>();
  if constexpr (I + 1 < sets.size())
    return with_one_of<sets, I + 1>(effects, f);
  else
    throw std::logic_error("no equations for this combination of effects");
}

/// Calls f.operator()<E>() with the effects of a scene.
template <class F>
auto with_effects(const Scene& scene, F&& f) {
  return with_one_of<all_effects>(effects(scene), f);
}

/// The same with the one of general_effects.
template <class F>
auto with_general_effects(const Scene& scene, F&& f) {
  Effects with_pivot = effects(scene);
  with_pivot.pivot = true;
  return with_one_of<general_effects>(with_pivot, f);
}

/// One point of the design space, in metres.
template <class T>
struct Design {
  T r1;  ///< the counterweight's arm
  T r3;  ///< the sling
  T r2;  ///< the throwing arm

  friend bool operator==(const Design&, const Design&) = default;
};

}  // namespace trebsweep
