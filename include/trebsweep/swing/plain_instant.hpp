#pragma once

#include <algorithm>

#include "trebsweep/ode/instant.hpp"
#include "trebsweep/swing/kernel.hpp"

namespace trebsweep {

/// The instant of the first lane.
template <class T, Effects E>
PlainInstant to_plain(const Instant<T, E>& at) {
  PlainInstant plain{get_lane(at.t, 0), {}, {}, {}};
  const auto first_lane_of = [](const T& numbers) { return get_lane(numbers, 0); };
  std::ranges::transform(at.x, plain.x.begin(), first_lane_of);
  std::ranges::transform(at.directions, plain.directions.begin(), first_lane_of);
  std::ranges::transform(at.dxdt, plain.dxdt.begin(), first_lane_of);
  return plain;
}

/// The instant in all lanes.
template <class T, Effects E>
Instant<T, E> to_instant(const PlainInstant& plain) {
  Instant<T, E> at{T(plain.t), {}, {}, {}};
  std::copy_n(plain.x.begin(), at.x.size(), at.x.begin());
  std::copy_n(plain.directions.begin(), at.directions.size(), at.directions.begin());
  std::copy_n(plain.dxdt.begin(), at.dxdt.size(), at.dxdt.begin());
  return at;
}

}  // namespace trebsweep
