#pragma once

#include <algorithm>

#include "trebsweep/ode/instant.hpp"
#include "trebsweep/swing/kernel.hpp"

namespace trebsweep {

/// The instant of the first lane.
template <class T, Effects E>
PlainInstant to_plain(const Instant<T, E>& at) {
  PlainInstant plain{get_lane(at.t, 0), {}, {}, {}};
  const auto copy = [](const auto& from, auto& to) {
    for (std::size_t i = 0; i < from.size(); ++i) to[i] = get_lane(from[i], 0);
  };
  copy(at.x, plain.x);
  copy(at.directions, plain.directions);
  copy(at.dxdt, plain.dxdt);
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

/// Whether the projectile of the first lane is in the trough.
template <class T, Effects E>
bool is_sliding(const Motion<T, E>& motion) {
  return get_lane(motion.sliding(), 0) > 0;
}

}  // namespace trebsweep
