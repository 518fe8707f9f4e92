#pragma once

#include <cmath>
#include <limits>

#include "trebsweep/simd/lanes.hpp"

namespace trebsweep {

/// The value and the derivative of a function.
template <class T>
struct ValueAndSlope {
  T value, slope;
};

/// Finds the root of an increasing function f on [low, high], f(low) < 0 <= f(high), in every lane
/// independently: Newton's method, safeguarded by bisection where it would leave the bracket (Press
/// et al., Numerical Recipes, 9.4, rtsafe).
///
/// A lane has converged when the next Newton step would be at most `precision`, |f| is at the level
/// of rounding errors, or no number is left in its bracket; its argument then stays fixed. The last
/// call of f is with the roots of all lanes, so that what f stores belongs to them. Gives up after
/// 100 iterations.
template <class T, class F>
void find_root(F f, T low, T high, T guess, const T& precision) {
  using std::abs;
  const T rounding = 8 * std::numeric_limits<typename Lanes<T>::Number>::epsilon();
  const auto inside = [&] { return (low < guess) & (guess < high); };
  guess = select(inside(), guess, T((low + high) / T(2)));
  for (int i = 0; i < 100; ++i) {
    const auto [value, slope] = f(guess);
    const auto converged =
        (abs(value) <= T(precision * slope)) | (abs(value) <= rounding) | !inside();
    if (!any(!converged)) return;
    const auto below = value < T(0);
    low = select(below & !converged, guess, low);
    high = select(below | converged, high, guess);
    const T here = guess;
    guess = here - value / slope;
    guess = select(inside(), guess, T((low + high) / T(2)));
    guess = select(converged, here, guess);
  }
}

}  // namespace trebsweep
