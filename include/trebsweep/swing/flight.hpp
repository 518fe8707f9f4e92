#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "trebsweep/model/mechanism.hpp"
#include "trebsweep/swing/drag.hpp"

namespace trebsweep {

// Positions are relative to the fulcrum and velocities relative to the ground, as in Mechanism.
// Where the projectile is below the ground at the release, every result is NaN.

/// The flight from the release to the ground.
template <class T>
struct Flight {
  T range;         ///< m: from the foot of the fulcrum to the impact, positive in the direction of
                   ///< the throw (+x)
  T time;          ///< s
  T impact_speed;  ///< m/s, relative to the ground
  T apex;          ///< m: the greatest height above the ground after the release
};

/// A projectile that lifts off from a trough on the ground is there up to rounding errors: so far
/// below the ground, m, counts as on it.
inline constexpr double ground_rounding = 1e-6;

/// Height above the ground, m; NaN below the ground.
template <class T>
T flight_height(const Scene& scene, const Vector<T>& position) {
  const T height = position.y + T(scene.fulcrum_height);
  const T above = select(height > T(0), height, T(0));
  return select(height >= T(-ground_rounding), above, T(std::numeric_limits<double>::quiet_NaN()));
}

/// The vertical speed at the impact, m/s, and the duration, s, of a flight without drag.
template <class T>
struct DragFreeFall {
  T speed, time;

  DragFreeFall(const Scene& scene, const T& height, const T& upward) {
    using std::sqrt;
    const T g(scene.gravity);
    speed = sqrt(T(upward * upward + T(2) * g * height));
    // The second form avoids cancellation.
    time = select(upward < T(0), T(T(2) * height / T(speed - upward)), T(T(upward + speed) / g));
  }
};

/// The flight of a projectile released at `position` (m) with `velocity` (m/s). Drag is integrated
/// with a relative error of about 1e-13 in double precision, 1e-17 in wider types; where that
/// takes more than max_flight_steps, range, time and speed are NaN.
template <class T>
Flight<T> flight(const Scene& scene, const Vector<T>& position, const Vector<T>& velocity) {
  using std::sqrt;
  const T height = flight_height(scene, position);
  if (drag_constant(scene) == 0) {
    const DragFreeFall<T> fall(scene, height, velocity.y);
    const T rise = select(velocity.y > T(0), velocity.y, T(0));
    return {position.x + velocity.x * fall.time, fall.time,
            sqrt(T(velocity.x * velocity.x + fall.speed * fall.speed)),
            height + rise * rise / T(2 * scene.gravity)};
  }

  using Number = typename Lanes<T>::Number;
  const double epsilon = static_cast<double>(std::numeric_limits<Number>::epsilon());
  auto at = release_into_air<T, 4>({position.x, height, velocity.x, velocity.y});
  const T apex = fly_to_ground(scene, std::max(450 * epsilon, 1e-17), at);
  const auto& [x, ground, vx, vy] = at.s;
  return {x, at.time, sqrt(T(vx * vx + vy * vy)), apex};
}

/// The deceleration (m/s^2) of a flight by drag.
template <class T>
Vector<T> deceleration(const Scene& scene, const Vector<T>& velocity) {
  using std::sqrt;
  const Vector<T> through_air = velocity + Vector<T>{T(-scene.wind), T(0)};
  return T(T(drag_constant(scene)) * sqrt(dot(through_air, through_air))) * through_air;
}

/// The range (m) and its derivative when `velocity` changes along `change` (in any unit). Drag is
/// integrated with a relative error of about `tolerance`. The derivative of a flight that ends
/// where it starts is zero.
template <class T>
ValueAndSlope<T> range_and_slope(const Scene& scene, const Vector<T>& position,
                                 const Vector<T>& velocity, const Vector<T>& change,
                                 double tolerance) {
  const T height = flight_height(scene, position);
  if (drag_constant(scene) == 0) {
    const DragFreeFall<T> fall(scene, height, velocity.y);
    const T path = select(fall.speed > T(0), T(velocity.x / fall.speed), T(0));
    return {position.x + velocity.x * fall.time, fall.time * T(change.x + path * change.y)};
  }

  auto at = release_into_air<T, 8>(
      {position.x, height, velocity.x, velocity.y, T(0), T(0), change.x, change.y});
  fly_to_ground(scene, tolerance, at);
  const auto& [x, ground, vx, vy, dx, dy, dvx, dvy] = at.s;
  return {x, dx - select(vy < T(0), T(vx / vy), T(0)) * dy};
}

/// An upper bound of the range (m) of a flight through air, without integrating it; NaN below the
/// ground.
///
/// Relative to the air, drag keeps the path below the parabola of a flight without it: drag does
/// not turn the velocity, and gravity turns it the faster the slower the projectile is. With a head
/// wind, the path over the ground is shorter as well: it takes at least as long as the parabola, or
/// it ends earlier, at no larger horizontal speed. A tail wind carries the projectile as long as it
/// flies, which is at most the rise without drag, and a fall at a speed at which the air, passing
/// at no more than the speed u of its energy, holds it: sqrt(2 H/g) + H k u/g from the height H.
template <class T>
T longest_range(const Scene& scene, const Vector<T>& position, const Vector<T>& velocity) {
  using std::sqrt;
  const T height = flight_height(scene, position), g(scene.gravity), none(0);
  const DragFreeFall<T> fall(scene, height, velocity.y);
  const T wind(std::max(scene.wind, 0.0)), ahead = velocity.x - wind;
  const T parabola = position.x + select(ahead > none, ahead, none) * fall.time;
  if (scene.wind <= 0) return parabola;
  const T rise = select(velocity.y > none, T(velocity.y / g), none);
  const T apex = height + T(0.5) * g * rise * rise;
  const T speed = sqrt(T(ahead * ahead + velocity.y * velocity.y + T(2) * g * height));
  const T longest = rise + sqrt(T(T(2) * apex / g)) + T(drag_constant(scene)) * speed * apex / g;
  return parabola + wind * longest;
}

// Instantiated in src/swing/flight.cpp and, for packs, src/swing/kernel/flight.cpp.
extern template Flight<double> flight(const Scene&, const Vector<double>&, const Vector<double>&);
extern template ValueAndSlope<double> range_and_slope(const Scene&, const Vector<double>&,
                                                      const Vector<double>&, const Vector<double>&,
                                                      double);
extern template Flight<Pack<3>> flight(const Scene&, const Vector<Pack<3>>&,
                                       const Vector<Pack<3>>&);
extern template ValueAndSlope<Pack<3>> range_and_slope(const Scene&, const Vector<Pack<3>>&,
                                                       const Vector<Pack<3>>&,
                                                       const Vector<Pack<3>>&, double);

}  // namespace trebsweep
