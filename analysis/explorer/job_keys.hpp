#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>
#include <type_traits>

#include "trebsweep/model/scene.hpp"
#include "trebsweep/ode/solver.hpp"

namespace trebsweep::explorer {

/// The job, set key by key.
inline Scene scene;
inline Solver solver;

inline Scene& owner(Scene*) { return scene; }
inline Solver& owner(Solver*) { return solver; }

/// The object that a pointer to a member of Scene or Solver selects.
template <class Section, class T>
T& selected(T Section::*member) {
  return owner(static_cast<Section*>(nullptr)).*member;
}

template <class T>
double number_of(const T& value) {
  return static_cast<double>(value);
}
inline double number_of(const std::optional<double>& value) {
  return value.value_or(std::numeric_limits<double>::quiet_NaN());
}

/// A key of a job as a number: yes and no are 1 and 0, a name its index, a missing value NaN.
struct Key {
  std::string_view name;
  double (*get)();
  void (*set)(double);
};

template <auto member>
constexpr Key key(std::string_view name) {
  return {name, [] { return number_of(selected(member)); },
          [](double x) {
            auto& value = selected(member);
            using T = std::remove_reference_t<decltype(value)>;
            if constexpr (std::is_same_v<T, std::optional<double>>)
              value = std::isnan(x) ? std::nullopt : std::optional(x);
            else
              value = static_cast<T>(x);
          }};
}

inline constexpr std::array keys{
    key<&Scene::gravity>("scene.gravity"),
    key<&Scene::counterweight_mass>("scene.counterweight-mass"),
    key<&Scene::projectile_mass>("scene.projectile-mass"),
    key<&Scene::release_height>("scene.release-height"),
    key<&Scene::fulcrum_height>("scene.fulcrum-height"),
    key<&Scene::beam_density>("scene.beam-density"),
    key<&Scene::beam_side>("scene.beam-side"),
    key<&Scene::beam_width>("scene.beam-width"),
    key<&Scene::beam_depth>("scene.beam-depth"),
    key<&Scene::beam_inertia>("scene.beam-inertia"),
    key<&Scene::sling_angle>("scene.sling-angle"),
    key<&Scene::pivot_viscosity>("scene.pivot-viscosity"),
    key<&Scene::pivot_friction>("scene.pivot-friction"),
    key<&Scene::sling_mass>("scene.sling-mass"),
    key<&Scene::sling_stiffness>("scene.sling-stiffness"),
    key<&Scene::sling_damping>("scene.sling-damping"),
    key<&Scene::beam_mass>("scene.beam-mass"),
    key<&Scene::beam_centre>("scene.beam-centre"),
    key<&Scene::beam_moment>("scene.beam-moment"),
    key<&Scene::beam_section_modulus>("scene.beam-section-modulus"),
    key<&Scene::counterweight_inertia>("scene.counterweight-inertia"),
    key<&Scene::start_angle>("scene.start-angle"),
    key<&Scene::start_tip_height>("scene.start-tip-height"),
    key<&Scene::counterweight_hanger>("scene.counterweight-hanger"),
    key<&Scene::trough>("scene.trough"),
    key<&Scene::trough_height>("scene.trough-height"),
    key<&Scene::projectile_diameter>("scene.projectile-diameter"),
    key<&Scene::drag_coefficient>("scene.drag-coefficient"),
    key<&Scene::air_density>("scene.air-density"),
    key<&Scene::wind>("scene.wind"),
    key<&Solver::release>("solver.release"),
    key<&Solver::release_angle>("solver.release-angle"),
    key<&Solver::pin_angle>("solver.pin-angle"),
    key<&Solver::max_time>("solver.max-time"),
    key<&Solver::max_steps>("solver.max-steps"),
};

}  // namespace trebsweep::explorer
