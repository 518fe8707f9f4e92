#pragma once

namespace trebsweep {

/// How the beam's mass resists turning: the paper's slender rod (18), the exact square prism, or
/// not at all (as in the paper's Appendix C, where only the beam's weight acts).
enum class BeamInertia { slender, prism, none };

/// The physical situation of every design of a job, in SI units; the defaults are the paper's.
struct Scene {
  double gravity = 9.8;              ///< g, m/s^2
  double counterweight_mass = 5000;  ///< m1, kg
  double projectile_mass = 100;      ///< m3, kg
  double release_height = 2;    ///< h, m: the counterweight's height above the ground at the start
  double fulcrum_height = 1.5;  ///< h0, m: the fulcrum's height above the ground
  double beam_density = 7850;   ///< rho, kg/m^3
  double beam_side = 0.10;      ///< s, m: side of the beam's square section
  BeamInertia beam_inertia = BeamInertia::slender;
  double sling_angle = 0;  ///< phi2(0), rad
};

/// One point of the design space, in metres.
template <class T>
struct Design {
  T r1;  ///< the counterweight's arm
  T r3;  ///< the sling
  T r2;  ///< the throwing arm
};

}  // namespace trebsweep
