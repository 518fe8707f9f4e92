#pragma once

#include <array>
#include <cstddef>

#include "trebsweep/model/scene.hpp"
#include "trebsweep/simd/lanes.hpp"
#include "trebsweep/simd/sin_cos.hpp"

namespace trebsweep {

/// Indices of the coordinates in a state: phi1 (rad, clockwise from the upward vertical to the
/// counterweight's arm), phi2 (rad, clockwise from the downward vertical to the sling), their rates
/// w1 and w2 (rad/s); with an elastic sling, its length (m) and the rate of that (m/s); with a
/// hanger, its angle phi3 (rad, clockwise from the downward vertical) and rate w3 (rad/s).
enum Coordinate : std::size_t {
  phi1,
  phi2,
  w1,
  w2,
  length,
  stretching,
  phi3 = length,
  w3 = stretching
};

template <Effects E>
inline constexpr std::size_t coordinates = E.elastic || E.hanger ? 6 : 4;

/// Whether a coordinate is the rate of another one.
constexpr bool is_rate(std::size_t coordinate) {
  return coordinate == w1 || coordinate == w2 || coordinate == stretching;
}

template <class T, Effects E = Effects{}>
using State = std::array<T, coordinates<E>>;

/// Indices of the sines and cosines of the angles.
enum Direction : std::size_t { sin1, cos1, sin2, cos2, sin3, cos3 };

/// The number of sines and cosines.
template <Effects E>
inline constexpr std::size_t direction_count = E.hanger ? 6 : 4;

template <class T, Effects E = Effects{}>
using Directions = std::array<T, direction_count<E>>;

template <Effects E, class T>
Directions<T, E> directions(const std::array<T, coordinates<E>>& x) {
  const auto a = sin_cos(x[phi1]), b = sin_cos(x[phi2]);
  if constexpr (E.hanger) {
    const auto c = sin_cos(x[phi3]);
    return {a.sin, a.cos, b.sin, b.cos, c.sin, c.cos};
  } else {
    return {a.sin, a.cos, b.sin, b.cos};
  }
}

}  // namespace trebsweep
