#pragma once

#include <type_traits>

#include "trebsweep/model/motion.hpp"

namespace trebsweep {

/// A time and the state of a swing at it, with the rates and the sines and cosines of the angles.
template <class T, Effects E = Effects{}>
struct Instant {
  T t;  ///< s
  State<T, E> x;
  Directions<T, E> directions;  ///< sines and cosines of the angles in x
  State<T, E> dxdt;
};

/// The instant with time t and state x.
template <class T, Effects E>
Instant<T, E> instant(const Motion<T, E>& motion, const std::type_identity_t<T>& t,
                      const State<T, E>& x) {
  Instant<T, E> now{t, x, directions<E>(x), {}};
  motion.rates(now.x, now.directions, now.dxdt);
  return now;
}

}  // namespace trebsweep
