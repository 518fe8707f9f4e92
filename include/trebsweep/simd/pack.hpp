#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "trebsweep/simd/register.hpp"

namespace trebsweep {

// Loops over registers are unrolled by a pragma: not every compiler would do so by itself, and
// otherwise packs would be copied through memory.

/// A boolean for every lane of a pack: all bits of the lane are set, or none.
template <std::size_t R>
struct Mask {
  std::array<Bits, R> v;

  [[gnu::always_inline]] friend Mask operator&(const Mask& a, const Mask& b) {
    Mask c;
#pragma GCC unroll 8
    for (std::size_t r = 0; r < R; ++r) c.v[r] = a.v[r] & b.v[r];
    return c;
  }
  [[gnu::always_inline]] friend Mask operator|(const Mask& a, const Mask& b) {
    Mask c;
#pragma GCC unroll 8
    for (std::size_t r = 0; r < R; ++r) c.v[r] = a.v[r] | b.v[r];
    return c;
  }
  [[gnu::always_inline]] friend Mask operator!(const Mask& a) {
    Mask c;
#pragma GCC unroll 8
    for (std::size_t r = 0; r < R; ++r) c.v[r] = ~a.v[r];
    return c;
  }
};

template <std::size_t R>
struct Product;

/// A number type with an independent value in every lane of R registers; Motion and the steppers
/// are templates over it. The number of lanes of a register is part of the type, so that code for
/// different instruction sets has different symbols.
///
/// A product followed by an addition or a subtraction is always one fused multiply-add. If the
/// compiler chose, results could depend on the size of the pack.
template <std::size_t R, std::size_t = register_lanes>
struct Pack {
  std::array<Register, R> v;

  Pack() = default;
  [[gnu::always_inline]] Pack(double x) {
#pragma GCC unroll 8
    for (std::size_t r = 0; r < R; ++r) v[r] = broadcast(x);
  }
  [[gnu::always_inline]] Pack(const Product<R>& p) {
#pragma GCC unroll 8
    for (std::size_t r = 0; r < R; ++r) v[r] = p.a.v[r] * p.b.v[r];
  }

  double operator[](std::size_t lane) const {
    return v[lane / register_lanes][lane % register_lanes];
  }
  void set(std::size_t lane, double x) { v[lane / register_lanes][lane % register_lanes] = x; }

  [[gnu::always_inline]] friend Pack operator+(const Pack& a, const Pack& b) {
    Pack c;
#pragma GCC unroll 8
    for (std::size_t r = 0; r < R; ++r) c.v[r] = a.v[r] + b.v[r];
    return c;
  }
  [[gnu::always_inline]] friend Pack operator-(const Pack& a, const Pack& b) {
    Pack c;
#pragma GCC unroll 8
    for (std::size_t r = 0; r < R; ++r) c.v[r] = a.v[r] - b.v[r];
    return c;
  }
  [[gnu::always_inline]] friend Pack operator-(const Pack& a) {
    Pack c;
#pragma GCC unroll 8
    for (std::size_t r = 0; r < R; ++r) c.v[r] = -a.v[r];
    return c;
  }
  [[gnu::always_inline]] friend Product<R> operator*(const Pack& a, const Pack& b) {
    return {a, b};
  }
  [[gnu::always_inline]] friend Pack operator/(const Pack& a, const Pack& b) {
    Pack c;
#pragma GCC unroll 8
    for (std::size_t r = 0; r < R; ++r) c.v[r] = a.v[r] / b.v[r];
    return c;
  }
  [[gnu::always_inline]] Pack& operator+=(const Pack& b) { return *this = *this + b; }
  [[gnu::always_inline]] Pack& operator+=(const Product<R>& b) { return *this = *this + b; }

  [[gnu::always_inline]] friend Mask<R> operator<(const Pack& a, const Pack& b) {
    Mask<R> m;
#pragma GCC unroll 8
    for (std::size_t r = 0; r < R; ++r) m.v[r] = std::bit_cast<Bits>(a.v[r] < b.v[r]);
    return m;
  }
  [[gnu::always_inline]] friend Mask<R> operator<=(const Pack& a, const Pack& b) {
    Mask<R> m;
#pragma GCC unroll 8
    for (std::size_t r = 0; r < R; ++r) m.v[r] = std::bit_cast<Bits>(a.v[r] <= b.v[r]);
    return m;
  }
  [[gnu::always_inline]] friend Mask<R> operator>(const Pack& a, const Pack& b) { return b < a; }
  [[gnu::always_inline]] friend Mask<R> operator>=(const Pack& a, const Pack& b) { return b <= a; }
};

/// An unevaluated product a b. It holds references, because flights through air take twice as long
/// if it copies packs: use it only within one expression.
template <std::size_t R>
struct Product {
  const Pack<R>&a, &b;

  [[gnu::always_inline]] friend Pack<R> operator+(const Product& p, const Pack<R>& c) {
    Pack<R> s;
#pragma GCC unroll 8
    for (std::size_t r = 0; r < R; ++r) s.v[r] = fma(p.a.v[r], p.b.v[r], c.v[r]);
    return s;
  }
  [[gnu::always_inline]] friend Pack<R> operator+(const Pack<R>& c, const Product& p) {
    return p + c;
  }
  [[gnu::always_inline]] friend Pack<R> operator+(const Product& p, const Product& q) {
    return q + Pack<R>(p);
  }
  [[gnu::always_inline]] friend Pack<R> operator-(const Product& p, const Pack<R>& c) {
    return p + -c;
  }
  [[gnu::always_inline]] friend Pack<R> operator-(const Pack<R>& c, const Product& p) {
    Pack<R> s;
#pragma GCC unroll 8
    for (std::size_t r = 0; r < R; ++r) s.v[r] = fma(-p.a.v[r], p.b.v[r], c.v[r]);
    return s;
  }
  [[gnu::always_inline]] friend Pack<R> operator-(const Product& p, const Product& q) {
    return Pack<R>(p) - q;
  }
  [[gnu::always_inline]] friend Pack<R> operator-(const Product& p) { return -Pack<R>(p); }
  [[gnu::always_inline]] friend Pack<R> operator*(const Product& p, const Pack<R>& c) {
    return Pack<R>(p) * c;
  }
  [[gnu::always_inline]] friend Pack<R> operator*(const Pack<R>& c, const Product& p) {
    return c * Pack<R>(p);
  }
  [[gnu::always_inline]] friend Pack<R> operator*(const Product& p, const Product& q) {
    return Pack<R>(p) * Pack<R>(q);
  }
  [[gnu::always_inline]] friend Pack<R> operator/(const Product& p, const Pack<R>& c) {
    return Pack<R>(p) / c;
  }
};

template <std::size_t R>
[[gnu::always_inline]] inline Pack<R> select(const Mask<R>& m, const Pack<R>& yes,
                                             const Pack<R>& no) {
  Pack<R> c;
#pragma GCC unroll 8
  for (std::size_t r = 0; r < R; ++r) c.v[r] = m.v[r] ? yes.v[r] : no.v[r];
  return c;
}

template <std::size_t R>
[[gnu::always_inline]] inline Pack<R> abs(const Pack<R>& a) {
  Pack<R> c;
#pragma GCC unroll 8
  for (std::size_t r = 0; r < R; ++r) c.v[r] = abs(a.v[r]);
  return c;
}

template <std::size_t R>
[[gnu::always_inline]] inline Pack<R> sqrt(const Pack<R>& a) {
  Pack<R> c;
#pragma GCC unroll 8
  for (std::size_t r = 0; r < R; ++r) c.v[r] = sqrt(a.v[r]);
  return c;
}

/// Computed lane by lane; equal arguments in adjacent lanes are computed once.
template <std::size_t R>
inline Pack<R> atan2(const Pack<R>& y, const Pack<R>& x) {
  Pack<R> angle;
  for (std::size_t i = 0; i < R * register_lanes; ++i) {
    const bool again = i > 0 && y[i] == y[i - 1] && x[i] == x[i - 1];
    angle.set(i, again ? angle[i - 1] : std::atan2(y[i], x[i]));
  }
  return angle;
}

/// (a / b)^e with a relative error below 2 % for positive normal operands, for step-size control. 0
/// counts as 2^-1023; infinity, and NaN with a clear sign bit, count as at least 2^1024.
template <std::size_t R>
[[gnu::always_inline]] inline Pack<R> rough_power(const Pack<R>& a, const Pack<R>& b, double e) {
  // The bits of a positive double, read as an integer, are a piecewise linear function of its log2.
  const auto logarithm = [](Register x) {
    const Bits bits = std::bit_cast<Bits>(x);
    const Bits exponent = (bits >> 52) | std::bit_cast<Bits>(broadcast(0x1p52));
    const Bits fraction = (bits & 0xfffffffffffff) | std::bit_cast<Bits>(broadcast(1));
    const Register m = std::bit_cast<Register>(fraction) - broadcast(1);
    return (std::bit_cast<Register>(exponent) - broadcast(0x1p52)) +
           m * fma(m, broadcast(-0.34), broadcast(1.34));
  };
  Pack<R> c;
#pragma GCC unroll 8
  for (std::size_t r = 0; r < R; ++r) {
    const Register p = (logarithm(a.v[r]) - logarithm(b.v[r])) * broadcast(e);
    const Register shifted = p + broadcast(0x1.8p52);
    const Register f = p - (shifted - broadcast(0x1.8p52));
    const Register power = fma(f, fma(f, broadcast(0.2402), broadcast(0.6931)), broadcast(1));
    c.v[r] =
        std::bit_cast<Register>(std::bit_cast<Bits>(power) + (std::bit_cast<Bits>(shifted) << 52));
  }
  return c;
}

/// The lanes of a mask as bits; bit i belongs to lane i.
template <std::size_t R>
[[gnu::always_inline]] inline std::uint32_t lanes_of(const Mask<R>& m) {
  std::uint32_t bits = 0;
#pragma GCC unroll 8
  for (std::size_t r = 0; r < R; ++r) bits |= sign_bits(m.v[r]) << (r * register_lanes);
  return bits;
}

template <std::size_t R>
[[gnu::always_inline]] inline bool any(const Mask<R>& m) {
  return lanes_of(m) != 0;
}

}  // namespace trebsweep
