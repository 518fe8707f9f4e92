#pragma once

#include <algorithm>
#include <cmath>

#include "trebsweep/model/mechanism.hpp"

namespace trebsweep {

/// Whether release_height determines phi1(0).
inline bool starts_at_release_height(const Scene& scene) {
  return !scene.start_angle && !scene.start_tip_height;
}

/// The arm whose height at the start determines phi1(0), unless start_angle does, m.
template <class T>
const T& start_arm(const Scene& scene, const Design<T>& design) {
  return scene.start_tip_height ? design.r2 : design.r1;
}

/// The height at the start, m: of the hinge, or of a fixed counterweight, above the fulcrum, h - h0
/// plus the length of a hanger; or of the fulcrum above the arm's tip.
inline double start_height(const Scene& scene) {
  if (scene.start_tip_height) return scene.fulcrum_height - *scene.start_tip_height;
  return scene.release_height - scene.fulcrum_height + scene.counterweight_hanger;
}

/// Whether the arm reaches the start height: r1 >= |h - h0| (39).
inline bool start_is_reachable(const Scene& scene, const Design<double>& design) {
  // Tolerates the rounding of h - h0: an arm of exactly that length starts upright.
  return scene.start_angle ||
         start_arm(scene, design) * (1 + 1e-12) >= std::abs(start_height(scene));
}

/// phi1(0), rad: given, or arccos(height / arm) as in (39). Requires start_is_reachable().
template <class T>
T start_angle(const Scene& scene, const Design<T>& design) {
  using std::atan2;
  using std::sqrt;
  if (scene.start_angle) return T(*scene.start_angle);
  const T height = start_height(scene);
  const T& arm = start_arm(scene, design);
  // The arccosine without cancellation near the unstable upright equilibrium.
  const T square = T(arm - height) * T(arm + height);
  return atan2(T(sqrt(select(square > T(0), square, T(0)))), height);
}

/// The height of the arm's tip above the trough at the start, m.
template <class T>
T start_above_trough(const Scene& scene, const Design<T>& design) {
  return T(scene.fulcrum_height - scene.trough_height) -
         design.r2 * sin_cos(start_angle(scene, design)).cos;
}

/// Whether the sling reaches the trough at the start, if there is one.
inline bool sling_reaches_trough(const Scene& scene, const Design<double>& design) {
  // Tolerates rounding like start_is_reachable(): a sling of exactly that length starts vertical.
  return !scene.trough || std::abs(start_above_trough(scene, design)) <= design.r3 * (1 + 1e-12);
}

/// The initial state: at rest, with the arm at start_angle(), a hanger that hangs down, and a sling
/// at its initial angle, or taut from the arm's tip to the trough. An elastic sling is stretched by
/// the weight it carries. Requires start_is_reachable() and sling_reaches_trough().
template <class T, Effects E = Effects{}>
State<T, E> start(const Scene& scene, const Design<T>& design) {
  using std::atan2;
  using std::sqrt;
  const T zero(0), angle = start_angle(scene, design);
  if constexpr (E.elastic) {
    const double load =
        SlingMasses(scene).coupling * scene.gravity * std::max(0.0, std::cos(scene.sling_angle));
    const T l = design.r3 + T(load / scene.sling_stiffness);
    return {angle, T(scene.sling_angle), zero, zero, l, zero};
  } else if constexpr (E.trough) {
    const T height = start_above_trough(scene, design);
    const T square = T(design.r3 - height) * T(design.r3 + height);
    const T across = sqrt(select(square > zero, square, zero));
    return {angle, T(-atan2(across, height)), zero, zero};
  } else {
    return {angle, T(scene.sling_angle), zero, zero};
  }
}

}  // namespace trebsweep
