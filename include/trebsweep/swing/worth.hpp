#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "trebsweep/ode/instant.hpp"
#include "trebsweep/swing/flight.hpp"
#include "trebsweep/swing/lane_state.hpp"
#include "trebsweep/swing/peak.hpp"

namespace trebsweep {

/// What a release at a moment of the swing is worth.
template <class T>
struct Worth {
  T value;      ///< the range by the rule farthest, the square of the speed by the rule fastest
  T slope;      ///< its rate along the swing
  T clearance;  ///< m above ground_rounding; below zero, value and slope are NaN
};

/// The projectile at a moment: position (m) and velocity (m/s), and the rate of the velocity of a
/// release (m/s^2) as the moment changes, where a flight does not change its own impact: only what
/// drives the projectile off the path of a free flight does.
template <class T>
struct FlightStart {
  Vector<T> position, velocity, change;
};

template <class T, Effects E>
FlightStart<T> flight_start(const Mechanism<T, E>& mechanism, const Instant<T, E>& at) {
  const Vector<T> velocity = mechanism.velocity(at.x, at.directions);
  return {mechanism.projectile(at.x, at.directions), velocity,
          mechanism.specific_force(at.x, at.directions, at.dxdt) +
              deceleration(mechanism.scene(), velocity)};
}

/// The height of a position above ground_rounding, m.
template <class T>
T clearance(const Scene& scene, const Vector<T>& position) {
  return position.y + T(scene.fulcrum_height + ground_rounding);
}

/// The worth of a moment; a flight through air is integrated with a relative error of about
/// `tolerance`.
template <class T, Effects E>
Worth<T> worth(Release rule, const Mechanism<T, E>& mechanism, const Instant<T, E>& at,
               double tolerance) {
  const Scene& scene = mechanism.scene();
  if (rule == Release::farthest) {
    const auto [position, velocity, change] = flight_start(mechanism, at);
    const auto range = range_and_slope(scene, position, velocity, change, tolerance);
    return {range.value, range.slope, clearance(scene, position)};
  }
  const Vector<T> velocity = mechanism.velocity(at.x, at.directions);
  const Vector<T> acceleration =
      mechanism.specific_force(at.x, at.directions, at.dxdt) + Vector<T>{T(0), T(-scene.gravity)};
  return {dot(velocity, velocity), T(2) * dot(velocity, acceleration), T(1)};
}

/// The number of parts of a fall that are searched separately for the best moment, which is good
/// enough to find the part that holds it.
inline constexpr std::size_t parts_of_fall = 4;

/// The ends of the parts.
template <class T>
using Nodes = std::array<T, parts_of_fall + 1>;

/// Worths at the ends of the parts of a fall. In other lanes than those of `exists`, and at the
/// ends of parts that cannot hold a moment better than `best`, they have no value.
template <class T, Effects E, class Mask>
std::array<Worth<T>, parts_of_fall + 1> worths_of_fall(
    Release rule, const Mechanism<T, E>& mechanism,
    const std::array<Instant<T, E>, parts_of_fall + 1>& at, const Mask& exists, const T& best) {
  constexpr double tolerance = 1e-5;
  constexpr std::size_t nodes = parts_of_fall + 1;
  constexpr std::size_t lanes = Lanes<T>::count;
  const Scene& scene = mechanism.scene();
  std::array<Worth<T>, nodes> worths;
  if (rule != Release::farthest || drag_constant(scene) == 0) {
    for (std::size_t i = 0; i < nodes; ++i) worths[i] = worth(rule, mechanism, at[i], tolerance);
    return worths;
  }

  const T none = -std::numeric_limits<double>::infinity();
  std::array<FlightStart<T>, nodes> starts;
  Nodes<T> bound;
  T largest_change = 0;
  for (std::size_t i = 0; i < nodes; ++i) {
    starts[i] = flight_start(mechanism, at[i]);
    worths[i] = {none, T(std::numeric_limits<double>::quiet_NaN()),
                 clearance(scene, starts[i].position)};
    const T longest = longest_range(scene, starts[i].position, starts[i].velocity);
    bound[i] = select(longest > none, longest, none);  // not NaN
    if (i > 0) {
      using std::abs;
      const T change = abs(T(bound[i] - bound[i - 1]));
      largest_change = select(change > largest_change, change, largest_change);
    }
  }
  // Between its ends, a part hardly exceeds both by more than the bound changes in the other parts.
  std::array<LaneMask, nodes> needed{};
  for (std::size_t i = 1; i < nodes; ++i) {
    const T larger_end = larger(bound[i - 1], bound[i]);
    const LaneMask reach = lanes_of(exists & (T(larger_end + largest_change) > best));
    needed[i - 1] |= reach;
    needed[i] |= reach;
  }
  // The flights of all nodes and lanes fill as few packs as possible.
  FlightStart<T> packed = starts[0];
  std::array<std::pair<std::size_t, std::size_t>, lanes> origin;  // node and lane
  std::size_t size = 0;
  const auto fly = [&] {
    const auto range =
        range_and_slope(scene, packed.position, packed.velocity, packed.change, tolerance);
    for (std::size_t k = 0; k < size; ++k) {
      const auto [node, lane] = origin[k];
      copy_lane<T>(worths[node].value, lane, range.value, k);
      copy_lane<T>(worths[node].slope, lane, range.slope, k);
    }
    size = 0;
  };
  for (std::size_t i = 0; i < nodes; ++i)
    for (LaneMask left = needed[i]; left != 0; left &= left - 1) {
      const std::size_t lane = first_lane(left);
      origin[size] = {i, lane};
      copy_lane<T>(packed, size, starts[i], lane);
      if (++size == lanes) fly();
    }
  if (size > 0) {
    for (std::size_t k = size; k < lanes; ++k) copy_lane<T>(packed, k, packed, 0);
    fly();
  }
  return worths;
}

}  // namespace trebsweep
