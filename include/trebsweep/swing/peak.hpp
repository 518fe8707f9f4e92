#pragma once

#include <array>
#include <cstddef>

#include "trebsweep/simd/lanes.hpp"

namespace trebsweep {

template <class T>
T larger(const T& a, const T& b) {
  return select(a < b, b, a);
}

template <class T>
T smaller(const T& a, const T& b) {
  return select(b < a, b, a);
}

/// A maximum and where it is.
template <class T>
struct Peak {
  T value, at;
};

/// The maximum of the interpolating polynomial through (nodes[i], values[i]) near the largest
/// value, located by Newton's method; the largest value itself where the polynomial is not larger.
/// `nodes` are in ascending order.
template <class T, std::size_t N>
Peak<T> peak(const std::array<double, N>& nodes, const std::array<T, N>& values) {
  T largest = values[0], node = nodes[0];
  for (std::size_t i = 1; i < N; ++i) {
    const auto is_larger = values[i] > largest;
    largest = select(is_larger, values[i], largest);
    node = select(is_larger, T(nodes[i]), node);
  }
  std::array<T, N> c = values;  // Newton's divided differences
  for (std::size_t k = 1; k < N; ++k)
    for (std::size_t i = N - 1; i >= k; --i)
      c[i] = T(c[i] - c[i - 1]) * T(1 / (nodes[i] - nodes[i - k]));
  T top = node, value, slope, half_bend;
  const auto evaluate = [&] {
    value = c[N - 1];
    slope = half_bend = T(0);
    for (std::size_t i = N - 1; i-- > 0;) {
      const T way = top - T(nodes[i]);
      half_bend = way * half_bend + slope;
      slope = way * slope + value;
      value = way * value + c[i];
    }
  };
  for (int i = 0; i < 2; ++i) {  // two iterations suffice from the nearest node
    evaluate();
    const T bend = half_bend + half_bend;
    top = top - slope / select(bend < T(0), bend, T(-1e300));
  }
  evaluate();
  const auto higher = (top > T(nodes[0])) & (top < T(nodes[N - 1])) & (value > largest);
  return {select(higher, value, largest), select(higher, top, node)};
}

}  // namespace trebsweep
