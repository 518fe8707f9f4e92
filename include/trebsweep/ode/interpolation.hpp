#pragma once

#include <array>
#include <cstddef>

#include "trebsweep/ode/instant.hpp"

namespace trebsweep {

/// Quintic Hermite interpolation of the motion between two instants: for each angle, and for the
/// length of an elastic sling, the polynomial with the values, rates and accelerations of both
/// ends.
///
/// Written as the integral of the cubic through the rates and accelerations, plus a term for the
/// difference between that integral and the end value.
template <class T, Effects E>
class Quintic {
 public:
  /// `h` (s) is the time from `from` to `to`; it may be zero.
  Quintic(const Instant<T, E>& from, const Instant<T, E>& to, const T& h)
      : from_(from.x), per_h_(T(1) / select(h > T(0), h, T(1))) {
    using std::abs;
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      const auto [position, rate] = coordinates_[i];
      const T v = h * from.x[rate], end_v = h * to.x[rate];
      const T a = h * h * from.dxdt[rate], end_a = h * h * to.dxdt[rate];
      const T distance = to.x[position] - from.x[position], rise = end_v - v;
      const T missed = T(distance - T(v + end_v) / T(2)) + T(end_a - a) / T(12);
      // For a very short step, division by h would amplify rounding errors of the end values.
      const auto is_significant = abs(missed) > T(T(1e-14) * T(T(1) + abs(to.x[position])));
      pairs_[i] = {v, a / T(2), rise - T(T(2) * a + end_a) / T(3),
                   T(T(a + end_a) - T(2) * rise) / T(4), select(is_significant, missed, T(0))};
    }
  }

  /// The state at the fraction s of the step, 0 <= s <= 1, the same in all lanes or one of each.
  template <class S>
  State<T, E> operator()(const S& s) const {
    const S rest = S(1) - s;
    const S missed = s * s * s * S(S(10) - S(15) * s + S(6) * s * s);
    const S missed_rate = S(30) * s * s * rest * rest;
    State<T, E> x;
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      const auto [position, rate] = coordinates_[i];
      const auto& c = pairs_[i];
      x[position] = from_[position] + T(s) * c.first + T(S(s * s)) * c.second +
                    T(S(s * s * s)) * c.third + T(S(s * s * s * s)) * c.fourth +
                    T(missed) * c.missed;
      const T change = T(S(S(2) * s)) * c.second + T(S(S(3) * s * s)) * c.third +
                       T(S(S(4) * s * s * s)) * c.fourth + T(missed_rate) * c.missed;
      x[rate] = from_[rate] + change * per_h_;
    }
    return x;
  }

 private:
  struct Coordinates {
    std::size_t position, rate;
  };
  /// Coefficients of the powers of s, and of the term for the missing difference.
  struct Coefficients {
    T first, second, third, fourth, missed;
  };
  static constexpr std::array<Coordinates, 3> coordinates_{
      {{phi1, w1}, {phi2, w2}, {length, stretching}}};

  State<T, E> from_;
  T per_h_;
  std::array<Coefficients, coordinates<E> / 2> pairs_;
};

}  // namespace trebsweep
