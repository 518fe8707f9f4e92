#pragma once

#include <algorithm>
#include <boost/math/constants/constants.hpp>
#include <limits>
#include <optional>
#include <vector>

namespace trebsweep {

/// A set of angles phi1 - phi2 (rad): those through which the angle has fallen since the lift-off,
/// at which no pin can release the projectile any more. A pin's angle is between -pi and pi: angles
/// beyond count as fallen through from the start.
template <class Number>
class FallenAngles {
 public:
  struct Interval {
    Number low, high;
  };

  void clear() { fallen_ = beyond_half_turns(); }

  /// The highest part of a fall from `high` to `low` that has not been fallen through before, if
  /// there is one.
  std::optional<Interval> new_part(Number high, const Number& low) const {
    for (auto known = fallen_.rbegin(); known != fallen_.rend() && high > low; ++known) {
      if (known->low >= high) continue;
      if (known->high < high) return Interval{std::max(low, known->high), high};
      high = known->low;
    }
    return std::nullopt;
  }

  /// Adds a fall from `high` to `low`.
  void add(Number high, Number low) {
    const auto first =
        std::find_if(fallen_.begin(), fallen_.end(), [&](const auto& i) { return i.high >= low; });
    auto end = first;
    for (; end != fallen_.end() && end->low <= high; ++end) {
      low = std::min(low, end->low);
      high = std::max(high, end->high);
    }
    if (first == end) {
      fallen_.insert(first, {low, high});
    } else {
      *first = {low, high};
      fallen_.erase(first + 1, end);
    }
  }

 private:
  static std::vector<Interval> beyond_half_turns() {
    const Number pi = boost::math::constants::pi<Number>();
    const Number infinity = std::numeric_limits<Number>::infinity();
    return {{-infinity, -pi}, {pi, infinity}};
  }

  std::vector<Interval> fallen_ = beyond_half_turns();  // disjoint, in ascending order
};

}  // namespace trebsweep
