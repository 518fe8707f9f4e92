#pragma once

#include <array>
#include <bit>
#include <cmath>

#include "trebsweep/simd/pack.hpp"

namespace trebsweep {

template <class T>
struct SinCos {
  T sin, cos;
};

/// Sine and cosine of a scalar.
template <class T>
SinCos<T> sin_cos(const T& x) {
  using std::cos;
  using std::sin;
  return {sin(x), cos(x)};
}

/// Sines and cosines of n pi/8, rounded to double.
struct Sixteenths {
  static constexpr double s1 = 0x1.87de2a6aea963p-2;  // sin(pi/8)
  static constexpr double s2 = 0x1.6a09e667f3bcdp-1;  // sin(pi/4)
  static constexpr double s3 = 0x1.d906bcf328d46p-1;  // sin(3 pi/8)
  alignas(64) static constexpr std::array<double, 16> sin{0, s1,  s2,  s3,  1,  s3,  s2,  s1,
                                                          0, -s1, -s2, -s3, -1, -s3, -s2, -s1};
  alignas(64) static constexpr std::array<double, 16> cos{1,  s3,  s2,  s1,  0, -s1, -s2, -s3,
                                                          -1, -s3, -s2, -s1, 0, s1,  s2,  s3};
};

/// Sine and cosine of n pi/8; n is in the lowest four bits of each lane.
[[gnu::always_inline]] inline SinCos<Register> sin_cos_of_sixteenths(Bits n) {
#if defined(__AVX512F__)
  const auto look_up = [&](const std::array<double, 16>& table) {
    return _mm512_permutex2var_pd(_mm512_load_pd(table.data()), std::bit_cast<__m512i>(n),
                                  _mm512_load_pd(table.data() + 8));
  };
  return {look_up(Sixteenths::sin), look_up(Sixteenths::cos)};
#elif defined(__AVX2__)
  // Tables of 32-bit words for n < 8, because a gather is many times slower; n >= 8 changes the
  // sign.
  constexpr auto words = [](const std::array<double, 16>& table, int shift) {
    std::array<std::uint32_t, 8> half{};
    for (std::size_t i = 0; i < 8; ++i)
      half[i] = static_cast<std::uint32_t>(std::bit_cast<std::uint64_t>(table[i]) >> shift);
    return half;
  };
  alignas(32) static constexpr std::array tables{
      words(Sixteenths::sin, 0), words(Sixteenths::sin, 32), words(Sixteenths::cos, 0),
      words(Sixteenths::cos, 32)};
  const __m256i index = _mm256_shuffle_epi32(std::bit_cast<__m256i>(n), 0xA0);
  const auto look_up = [&](std::size_t t) {
    const auto* table = reinterpret_cast<const __m256i*>(tables[t].data());
    return _mm256_permutevar8x32_epi32(_mm256_load_si256(table), index);
  };
  const Bits sign = (n << 60) & INT64_MIN;
  const auto value = [&](std::size_t t) {
    const Bits size = std::bit_cast<Bits>(_mm256_blend_epi32(look_up(t), look_up(t + 1), 0xAA));
    return std::bit_cast<Register>(size ^ sign);
  };
  return {value(0), value(2)};
#else
  SinCos<Register> a;
  for (std::size_t lane = 0; lane < register_lanes; ++lane) {
    const auto i = static_cast<std::size_t>(n[lane] & 15);
    a.sin[lane] = Sixteenths::sin[i];
    a.cos[lane] = Sixteenths::cos[i];
  }
  return a;
#endif
}

/// Sine and cosine of a register: within 2 ULP for |x| <= 1e5, less accurate as |x| grows, NaN if x
/// is not finite.
///
/// Argument reduction x = n pi/8 + r with pi/8 in two parts (Cody and Waite), polynomials in r, and
/// the angle-sum formulas with a table over n. The polynomials are minimax approximations for
/// |r| <= pi/16; pack_test measures their error.
[[gnu::always_inline]] inline SinCos<Register> sin_cos(Register x) {
  if constexpr (!has_fused_multiply_add) {  // the C library is as fast then
    SinCos<Register> a;
    for (std::size_t lane = 0; lane < register_lanes; ++lane) {
      a.sin[lane] = std::sin(x[lane]);
      a.cos[lane] = std::cos(x[lane]);
    }
    return a;
  }
  const auto c = [](double value) { return broadcast(value); };
  // Adding 1.5 2^52 rounds to an integer, which is then in the lowest bits.
  const Register shift = c(0x1.8p52);
  const Register shifted = fma(x, c(0x1.45f306dc9c883p+1), shift);
  const Register n = shifted - shift;
  Register r = fma(n, c(-0x1.921fb54442d18p-2), x);
  r = fma(n, c(-0x1.1a62633145c07p-56), r);
  const Register z = r * r;
  Register s = fma(z, c(2.7533788549326874e-06), c(-0.00019841262220339254));
  s = fma(s, z, c(0.008333333332360533));
  s = fma(s, z, c(-0.1666666666666628));
  s = fma(s, z * r, r);  // sin r
  Register k = fma(z, c(-2.753360116208143e-07), c(2.480157727475973e-05));
  k = fma(k, z, c(-0.0013888888886964587));
  k = fma(k, z, c(0.041666666666665055));
  k = fma(k, z, c(-0.5));
  k = k * z;  // cos r - 1
  const auto [S, C] = sin_cos_of_sixteenths(std::bit_cast<Bits>(shifted));
  return {S + fma(C, s, S * k), C + fma(-S, s, C * k)};
}

template <std::size_t R>
[[gnu::always_inline]] inline SinCos<Pack<R>> sin_cos(const Pack<R>& x) {
  SinCos<Pack<R>> a;
  for (std::size_t r = 0; r < R; ++r) {
    const auto [sin, cos] = sin_cos(x.v[r]);
    a.sin.v[r] = sin;
    a.cos.v[r] = cos;
  }
  return a;
}

}  // namespace trebsweep
