#pragma once

#ifdef __x86_64__
#include <immintrin.h>
#endif

#include <bit>
#include <cstddef>
#include <cstdint>

namespace trebsweep {

// SIMD registers by GCC's and Clang's vector extensions. Debian's xsimd 8.1 lacks a fused
// multiply-add for AVX-512, so that maps would differ between AVX2 and AVX-512;
// std::experimental::simd computes it element by element.

// Only the preprocessor knows the instruction set. Without AVX2, and on other processors,
// operations that the vector extensions lack are written lane by lane; compilers combine the lanes.
#if defined(__AVX512F__)
inline constexpr std::size_t register_lanes = 8;
#elif defined(__AVX2__)
inline constexpr std::size_t register_lanes = 4;
#else
inline constexpr std::size_t register_lanes = 2;
#endif

/// Whether fma() is fused, that is, rounded once. It is on every target except baseline x86-64 and
/// WebAssembly.
#if (defined(__x86_64__) && !defined(__FMA__)) || defined(__wasm__)
inline constexpr bool has_fused_multiply_add = false;
#else
inline constexpr bool has_fused_multiply_add = true;
#endif

/// A register of doubles, and one of 64-bit integers.
using Register = double __attribute__((vector_size(8 * register_lanes)));
using Bits = std::int64_t __attribute__((vector_size(8 * register_lanes)));

[[gnu::always_inline]] inline Register broadcast(double x) { return Register{} + x; }

/// a b + c, rounded once if has_fused_multiply_add.
[[gnu::always_inline]] inline Register fma(Register a, Register b, Register c) {
#if defined(__AVX512F__)
  return _mm512_fmadd_pd(a, b, c);
#elif defined(__AVX2__)
  return _mm256_fmadd_pd(a, b, c);
#else
  if constexpr (!has_fused_multiply_add) return a * b + c;
  // In this form GCC makes one vector instruction of it.
  return Register{__builtin_fma(a[0], b[0], c[0]), __builtin_fma(a[1], b[1], c[1])};
#endif
}

[[gnu::always_inline]] inline Register sqrt(Register x) {
#if defined(__AVX512F__)
  return _mm512_maskz_sqrt_pd(0xff, x);
#elif defined(__AVX2__)
  return _mm256_sqrt_pd(x);
#else
  for (std::size_t i = 0; i < register_lanes; ++i) x[i] = __builtin_sqrt(x[i]);
  return x;
#endif
}

[[gnu::always_inline]] inline Register abs(Register x) {
  return std::bit_cast<Register>(std::bit_cast<Bits>(x) & INT64_MAX);
}

/// The sign bits of all lanes; bit i belongs to lane i.
[[gnu::always_inline]] inline std::uint32_t sign_bits(Bits x) {
#if defined(__AVX512F__)
  return _mm512_cmplt_epi64_mask(std::bit_cast<__m512i>(x), _mm512_setzero_si512());
#elif defined(__AVX2__)
  return static_cast<std::uint32_t>(_mm256_movemask_pd(std::bit_cast<__m256d>(x)));
#else
  std::uint32_t bits = 0;
  for (std::size_t i = 0; i < register_lanes; ++i) bits |= std::uint32_t{x[i] < 0} << i;
  return bits;
#endif
}

}  // namespace trebsweep
