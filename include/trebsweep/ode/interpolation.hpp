#pragma once

#include <array>
#include <cstddef>

#include "trebsweep/ode/stepper.hpp"

namespace trebsweep {

/// The motion between two instants by interpolation: of each angle, and of an elastic sling's
/// length, the polynomial of degree five that has its values, rates and accelerations at both ends.
///
/// Its rate is the cubic that has the rates and accelerations, and a term that adds what the
/// integral of that cubic misses.
template <class T, Effects E>
class Quintic {
 public:
  /// `h` is the time from `from` to `to`; it may be zero.
  Quintic(const Instant<T, E>& from, const Instant<T, E>& to, const T& h)
      : from_(from.x), per_h_(T(1) / select(h > T(0), h, T(1))) {
    using std::abs;
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      const auto [place, rate] = places_[i];
      const T v = h * from.x[rate], end_v = h * to.x[rate];
      const T a = h * h * from.dxdt[rate], end_a = h * h * to.dxdt[rate];
      const T way = to.x[place] - from.x[place], rise = end_v - v;
      const T missed = T(way - T(v + end_v) / T(2)) + T(end_a - a) / T(12);
      // Divided by a very short step, a rounding of the ends would count.
      const auto counts = abs(missed) > T(T(1e-14) * T(T(1) + abs(to.x[place])));
      pairs_[i] = {v, a / T(2), rise - T(T(2) * a + end_a) / T(3),
                   T(T(a + end_a) - T(2) * rise) / T(4), select(counts, missed, T(0))};
    }
  }

  /// The state after a part of the way, from 0 to 1.
  State<T, E> operator()(double s) const {
    const double missed = s * s * s * (10 - 15 * s + 6 * s * s);
    const double missed_rate = 30 * s * s * (1 - s) * (1 - s);
    State<T, E> x;
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      const auto [place, rate] = places_[i];
      const auto& c = pairs_[i];
      x[place] = from_[place] + T(s) * c.first + T(s * s) * c.second + T(s * s * s) * c.third +
                 T(s * s * s * s) * c.fourth + T(missed) * c.missed;
      const T change = T(2 * s) * c.second + T(3 * s * s) * c.third + T(4 * s * s * s) * c.fourth +
                       T(missed_rate) * c.missed;
      x[rate] = from_[rate] + change * per_h_;
    }
    return x;
  }

 private:
  struct Pair {
    std::size_t place, rate;
  };
  /// Coefficients of the powers of the part of the way, and of the last term.
  struct Coefficients {
    T first, second, third, fourth, missed;
  };
  static constexpr std::array<Pair, 3> places_{{{phi1, w1}, {phi2, w2}, {length, stretching}}};

  State<T, E> from_;
  T per_h_;
  std::array<Coefficients, coordinates<E> / 2> pairs_;
};

}  // namespace trebsweep
