#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "trebsweep/simd/pack.hpp"

namespace trebsweep {

// The operations of Pack for scalar number types, so that templates accept both.

template <class T>
T select(bool m, const T& yes, const T& no) {
  return m ? yes : no;
}

template <class T>
T rough_power(const T& a, const T& b, double e) {
  using std::pow;
  return pow(T(a / b), T(e));
}

inline std::uint32_t lanes_of(bool m) { return m ? 1 : 0; }
inline bool any(bool m) { return m; }

/// The number type of one lane of T, and the number of lanes.
template <class T>
struct Lanes {
  using Number = T;
  static constexpr std::size_t count = 1;
};

template <std::size_t R>
struct Lanes<Pack<R>> {
  using Number = double;
  static constexpr std::size_t count = R * register_lanes;
};

template <class T>
const T& get_lane(const T& x, std::size_t) {
  return x;
}

template <std::size_t R>
double get_lane(const Pack<R>& x, std::size_t lane) {
  return x[lane];
}

template <class T>
void set_lane(T& x, std::size_t, const std::type_identity_t<T>& value) {
  x = value;
}

template <std::size_t R>
void set_lane(Pack<R>& x, std::size_t lane, double value) {
  x.set(lane, value);
}

/// Copies lane j of every number in `from` to lane i of `to`; Struct consists of numbers T only.
template <class T, class Struct>
void copy_lane(Struct& to, std::size_t i, const Struct& from, std::size_t j) {
  constexpr std::size_t lanes = Lanes<T>::count;
  if constexpr (lanes == 1) {
    to = from;
  } else {
    static_assert(std::is_trivially_copyable_v<Struct> && sizeof(Struct) % sizeof(T) == 0);
    auto* out = reinterpret_cast<double*>(&to);
    const auto* in = reinterpret_cast<const double*>(&from);
    for (std::size_t n = 0; n < sizeof(Struct) / sizeof(T); ++n)
      out[n * lanes + i] = in[n * lanes + j];
  }
}

/// Copies every number in `from` to `to` in the lanes of a mask; Struct consists of numbers T only.
template <class T, class Mask, class Struct>
void copy_where(const Mask& mask, Struct& to, const Struct& from) {
  if constexpr (Lanes<T>::count == 1) {
    if (mask) to = from;
  } else {
    static_assert(std::is_trivially_copyable_v<Struct> && sizeof(Struct) % sizeof(T) == 0);
    auto* out = reinterpret_cast<T*>(&to);
    const auto* in = reinterpret_cast<const T*>(&from);
    for (std::size_t n = 0; n < sizeof(Struct) / sizeof(T); ++n)
      out[n] = select(mask, in[n], out[n]);
  }
}

/// Register r of every number in `from`, which consists of packs of R registers only. One is the
/// same type for packs of one register.
template <class One, std::size_t R, class Struct>
[[gnu::always_inline]] inline One get_register(const Struct& from, std::size_t r) {
  static_assert(std::is_trivially_copyable_v<Struct> && sizeof(Struct) == R * sizeof(One));
  One to;
  auto* const out = reinterpret_cast<Register*>(&to);
  const auto* const in = reinterpret_cast<const Register*>(&from) + r;
#pragma GCC unroll 32
  for (std::size_t n = 0; n < sizeof(One) / sizeof(Register); ++n) out[n] = in[n * R];
  return to;
}

/// Sets register r of every number in `to`; see get_register().
template <std::size_t R, class Struct, class One>
[[gnu::always_inline]] inline void set_register(Struct& to, std::size_t r, const One& from) {
  static_assert(std::is_trivially_copyable_v<Struct> && sizeof(Struct) == R * sizeof(One));
  auto* const out = reinterpret_cast<Register*>(&to) + r;
  const auto* const in = reinterpret_cast<const Register*>(&from);
#pragma GCC unroll 32
  for (std::size_t n = 0; n < sizeof(One) / sizeof(Register); ++n) out[n * R] = in[n];
}

}  // namespace trebsweep
