#pragma once

#include <immintrin.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace trebsweep {

// The instruction set is known to the preprocessor alone.
#if defined(__AVX512F__)
inline constexpr std::size_t register_lanes = 8;
#elif defined(__AVX2__)
inline constexpr std::size_t register_lanes = 4;
#else
inline constexpr std::size_t register_lanes = 2;
#endif

/// One register of doubles, and one of integers of the same size.
using Register = double __attribute__((vector_size(8 * register_lanes)));
using Bits = std::int64_t __attribute__((vector_size(8 * register_lanes)));

[[gnu::always_inline]] inline Register broadcast(double x) { return Register{} + x; }

/// a b + c, rounded once where the machine can.
[[gnu::always_inline]] inline Register fma(Register a, Register b, Register c) {
#if defined(__AVX512F__)
  return _mm512_fmadd_pd(a, b, c);
#elif defined(__FMA__)
  return _mm256_fmadd_pd(a, b, c);
#else
  return a * b + c;
#endif
}

[[gnu::always_inline]] inline Register sqrt(Register x) {
#if defined(__AVX512F__)
  return _mm512_maskz_sqrt_pd(0xff, x);
#elif defined(__AVX2__)
  return _mm256_sqrt_pd(x);
#else
  return _mm_sqrt_pd(x);
#endif
}

/// a / b, correctly rounded, for finite numbers whose quotient and 1/b are normal.
[[gnu::always_inline]] inline Register quotient(Register a, Register b) {
#if defined(__AVX512F__)
  // The divider takes 16 cycles. Newton's method from 14 bits of 1/b, then Markstein's last step.
  const Register approximate = _mm512_maskz_rcp14_pd(0xff, b);
  const Register e = fma(-b, approximate, broadcast(1));
  const Register better = fma(e, approximate, approximate);
  const Register inverse = fma(e * e, better, better);
  const Register q = a * inverse;
  return fma(fma(-b, q, a), inverse, q);
#else
  return a / b;
#endif
}

[[gnu::always_inline]] inline Register abs(Register x) {
  return std::bit_cast<Register>(std::bit_cast<Bits>(x) & INT64_MAX);
}

/// The sign bits of a register, the first lane's lowest.
[[gnu::always_inline]] inline std::uint32_t sign_bits(Bits x) {
#if defined(__AVX512F__)
  return _mm512_cmplt_epi64_mask(std::bit_cast<__m512i>(x), _mm512_setzero_si512());
#elif defined(__AVX2__)
  return static_cast<std::uint32_t>(_mm256_movemask_pd(std::bit_cast<__m256d>(x)));
#else
  return static_cast<std::uint32_t>(_mm_movemask_pd(std::bit_cast<__m128d>(x)));
#endif
}

/// A truth for every lane of a pack: all bits of a lane set, or none.
template <std::size_t R>
struct Mask {
  std::array<Bits, R> v;

  [[gnu::always_inline]] friend Mask operator&(const Mask& a, const Mask& b) {
    Mask c;
    for (std::size_t r = 0; r < R; ++r) c.v[r] = a.v[r] & b.v[r];
    return c;
  }
  [[gnu::always_inline]] friend Mask operator|(const Mask& a, const Mask& b) {
    Mask c;
    for (std::size_t r = 0; r < R; ++r) c.v[r] = a.v[r] | b.v[r];
    return c;
  }
  [[gnu::always_inline]] friend Mask operator!(const Mask& a) {
    Mask c;
    for (std::size_t r = 0; r < R; ++r) c.v[r] = ~a.v[r];
    return c;
  }
};

template <std::size_t R>
struct Product;

/// R registers of doubles that stand for one number in each lane: a number type for Motion and the
/// steppers.
///
/// A product that is added or subtracted becomes one fused multiply-add, always: were that left to
/// the compiler, results would depend on what it does with packs of one size or another.
template <std::size_t R>
struct Pack {
  std::array<Register, R> v;

  Pack() = default;
  [[gnu::always_inline]] Pack(double x) {
    for (std::size_t r = 0; r < R; ++r) v[r] = broadcast(x);
  }
  [[gnu::always_inline]] Pack(const Product<R>& p) {
    for (std::size_t r = 0; r < R; ++r) v[r] = p.a.v[r] * p.b.v[r];
  }

  double operator[](std::size_t lane) const {
    return v[lane / register_lanes][lane % register_lanes];
  }
  void set(std::size_t lane, double x) { v[lane / register_lanes][lane % register_lanes] = x; }

  [[gnu::always_inline]] friend Pack operator+(const Pack& a, const Pack& b) {
    Pack c;
    for (std::size_t r = 0; r < R; ++r) c.v[r] = a.v[r] + b.v[r];
    return c;
  }
  [[gnu::always_inline]] friend Pack operator-(const Pack& a, const Pack& b) {
    Pack c;
    for (std::size_t r = 0; r < R; ++r) c.v[r] = a.v[r] - b.v[r];
    return c;
  }
  [[gnu::always_inline]] friend Pack operator-(const Pack& a) {
    Pack c;
    for (std::size_t r = 0; r < R; ++r) c.v[r] = -a.v[r];
    return c;
  }
  [[gnu::always_inline]] friend Product<R> operator*(const Pack& a, const Pack& b) {
    return {a, b};
  }
  [[gnu::always_inline]] friend Pack operator/(const Pack& a, const Pack& b) {
    Pack c;
    for (std::size_t r = 0; r < R; ++r) c.v[r] = a.v[r] / b.v[r];
    return c;
  }
  [[gnu::always_inline]] Pack& operator+=(const Pack& b) { return *this = *this + b; }
  [[gnu::always_inline]] Pack& operator+=(const Product<R>& b) { return *this = *this + b; }

  [[gnu::always_inline]] friend Mask<R> operator<(const Pack& a, const Pack& b) {
    Mask<R> m;
    for (std::size_t r = 0; r < R; ++r) m.v[r] = std::bit_cast<Bits>(a.v[r] < b.v[r]);
    return m;
  }
  [[gnu::always_inline]] friend Mask<R> operator<=(const Pack& a, const Pack& b) {
    Mask<R> m;
    for (std::size_t r = 0; r < R; ++r) m.v[r] = std::bit_cast<Bits>(a.v[r] <= b.v[r]);
    return m;
  }
  [[gnu::always_inline]] friend Mask<R> operator>(const Pack& a, const Pack& b) { return b < a; }
  [[gnu::always_inline]] friend Mask<R> operator>=(const Pack& a, const Pack& b) { return b <= a; }
};

/// a b, not yet rounded; it refers to its factors, and lives no longer than an expression.
template <std::size_t R>
struct Product {
  const Pack<R>&a, &b;

  [[gnu::always_inline]] friend Pack<R> operator+(const Product& p, const Pack<R>& c) {
    Pack<R> s;
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
  for (std::size_t r = 0; r < R; ++r) c.v[r] = m.v[r] ? yes.v[r] : no.v[r];
  return c;
}

/// a / b for operands that are not known beforehand: the compiler can only compute constants with
/// the operator.
template <std::size_t R>
[[gnu::always_inline]] inline Pack<R> quotient(const Pack<R>& a, const Pack<R>& b) {
  Pack<R> c;
  for (std::size_t r = 0; r < R; ++r) c.v[r] = quotient(a.v[r], b.v[r]);
  return c;
}

template <std::size_t R>
[[gnu::always_inline]] inline Pack<R> abs(const Pack<R>& a) {
  Pack<R> c;
  for (std::size_t r = 0; r < R; ++r) c.v[r] = abs(a.v[r]);
  return c;
}

template <std::size_t R>
[[gnu::always_inline]] inline Pack<R> sqrt(const Pack<R>& a) {
  Pack<R> c;
  for (std::size_t r = 0; r < R; ++r) c.v[r] = sqrt(a.v[r]);
  return c;
}

/// Lane by lane; neighbours that ask for the same angle share the work.
template <std::size_t R>
inline Pack<R> atan2(const Pack<R>& y, const Pack<R>& x) {
  Pack<R> angle;
  for (std::size_t i = 0; i < R * register_lanes; ++i) {
    const bool again = i > 0 && y[i] == y[i - 1] && x[i] == x[i - 1];
    angle.set(i, again ? angle[i - 1] : std::atan2(y[i], x[i]));
  }
  return angle;
}

/// (a/b)^e to within two percent, for what is not critical; a / b where both are finite, above zero
/// and no subnormals.
template <std::size_t R>
[[gnu::always_inline]] inline Pack<R> rough_power(const Pack<R>& a, const Pack<R>& b, double e) {
  // A number's bits, read as a whole one, are nearly its logarithm.
  const auto logarithm = [](Register x) {
    const Bits bits = std::bit_cast<Bits>(x);
    const Bits exponent = (bits >> 52) | std::bit_cast<Bits>(broadcast(0x1p52));
    const Bits fraction = (bits & 0xfffffffffffff) | std::bit_cast<Bits>(broadcast(1));
    const Register m = std::bit_cast<Register>(fraction) - broadcast(1);
    return (std::bit_cast<Register>(exponent) - broadcast(0x1p52)) +
           m * fma(m, broadcast(-0.34), broadcast(1.34));
  };
  Pack<R> c;
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

/// The lanes that are true, the first one's bit lowest.
template <std::size_t R>
[[gnu::always_inline]] inline std::uint32_t lanes_of(const Mask<R>& m) {
  std::uint32_t bits = 0;
  for (std::size_t r = 0; r < R; ++r) bits |= sign_bits(m.v[r]) << (r * register_lanes);
  return bits;
}

template <std::size_t R>
[[gnu::always_inline]] inline bool any(const Mask<R>& m) {
  return lanes_of(m) != 0;
}

// The same for single numbers, so that one text serves both.

template <class T>
T select(bool m, const T& yes, const T& no) {
  return m ? yes : no;
}

template <class T>
T quotient(const T& a, const T& b) {
  return a / b;
}

template <class T>
T rough_power(const T& a, const T& b, double e) {
  using std::pow;
  return pow(T(a / b), T(e));
}

inline std::uint32_t lanes_of(bool m) { return m ? 1 : 0; }
inline bool any(bool m) { return m; }

/// What a lane of T holds, and how many lanes there are.
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

/// Copies lane j of each number in `from`, a struct made of numbers T alone, to lane i of `to`.
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

}  // namespace trebsweep
