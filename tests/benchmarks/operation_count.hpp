#pragma once

#include <immintrin.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "trebsweep/ode/step_size.hpp"
#include "trebsweep/ode/steppers.hpp"

// A lower limit for the time of a step: the register operations that it takes, and the time of one.

namespace trebsweep {

/// A number that records the expression it was computed by, to count operations on SIMD registers.
/// As in a pack, a product and a sum fuse into one operation. Multiplications by 1 cost nothing.
struct Counted {
  struct Operation {
    int cost;
    std::vector<Counted> operands;
  };
  std::shared_ptr<const Operation> from = {};
  bool one = false;

  struct Product {
    std::shared_ptr<const Operation> multiply;
    bool by_one;
  };

  Counted() = default;
  Counted(double x) : one(x == 1) {}
  Counted(const Product& p) : from(p.multiply) {}
  Counted(int cost, std::vector<Counted> operands)
      : from(std::make_shared<Operation>(Operation{cost, std::move(operands)})) {}

  friend Product operator*(const Counted& a, const Counted& b) {
    const bool by_one = a.one || b.one;
    return {Counted(by_one ? 0 : 1, {a, b}).from, by_one};
  }
  /// A fused multiply-add.
  static Counted fused(const Product& p, const Counted& c) {
    return {p.by_one ? 1 : p.multiply->cost, {p.multiply->operands[0], p.multiply->operands[1], c}};
  }
  friend Counted operator+(const Counted& a, const Counted& b) { return {1, {a, b}}; }
  friend Counted operator-(const Counted& a, const Counted& b) { return {1, {a, b}}; }
  friend Counted operator-(const Counted& a) { return {1, {a}}; }
  friend Counted operator+(const Product& p, const Counted& c) { return fused(p, c); }
  friend Counted operator-(const Product& p, const Counted& c) { return fused(p, c); }
  friend Counted operator+(const Counted& c, const Product& p) { return fused(p, c); }
  friend Counted operator-(const Counted& c, const Product& p) { return fused(p, c); }
  friend Counted operator+(const Product& p, const Product& q) { return fused(q, p); }
  friend Counted operator-(const Product& p, const Product& q) { return fused(q, p); }
  friend Counted operator/(const Counted& a, const Counted& b) { return {3, {a, b}}; }
  Counted& operator+=(const Counted& b) { return *this = *this + b; }
  Counted& operator+=(const Product& b) { return *this = *this + b; }
  // Masks are counted like numbers.
  friend Counted operator<(const Counted& a, const Counted& b) { return {1, {a, b}}; }
  friend Counted operator<=(const Counted& a, const Counted& b) { return {1, {a, b}}; }
  friend Counted operator>(const Counted& a, const Counted& b) { return {1, {a, b}}; }
  friend Counted select(const Counted& m, const Counted& a, const Counted& b) {
    return {1, {m, a, b}};
  }
  friend Counted abs(const Counted& a) { return {1, {a}}; }
  // Counted by hand from pack.hpp and sin_cos.hpp, for AVX-512.
  friend Counted rough_power(const Counted& a, const Counted& b, double) { return {22, {a, b}}; }
  friend SinCos<Counted> sin_cos(const Counted& x) {
    const Counted both(26, {x});
    return {Counted(0, {both}), Counted(0, {both})};
  }
};

/// The cost of the operations behind a number that are not in `seen`; adds them to it.
inline int operations(const Counted& x, std::set<const Counted::Operation*>& seen) {
  if (!x.from || !seen.insert(x.from.get()).second) return 0;
  int sum = x.from->cost;
  for (const Counted& operand : x.from->operands) sum += operations(operand, seen);
  return sum;
}

template <>
struct Lanes<Counted> {
  using Number = double;
  static constexpr std::size_t count = 1;
};

/// The number of register operations in a step, including step-size control. Operations whose
/// result is unused are not counted, as the compiler removes them.
template <class Stepper>
int operations_per_step() {
  const Instant<Counted> from{};
  Instant<Counted> to;
  State<Counted> error;
  Stepper stepper;
  advance(stepper, Motion<Counted>(), from, Counted(), to, error);
  std::vector<Counted> results{to.t};
  for (const auto& part : {to.x, to.directions, to.dxdt})
    results.insert(results.end(), part.begin(), part.end());
  if constexpr (is_adaptive<Stepper>) {
    const auto ratio = error_ratio(from, to, error, Counted(), 1e-9);
    results.push_back(Counted() * step_factor(ratio, stepper.error_order()));
    results.push_back(ratio.error <= ratio.allowed);
  }
  std::set<const Counted::Operation*> seen;
  int sum = 0;
  for (const Counted& x : results) sum += operations(x, seen);
  return sum;
}

/// The shortest time per fused multiply-add of AVX-512 registers (s): the best of many rounds of
/// independent operations.
__attribute__((target("avx512f"))) inline double seconds_per_operation() {
  constexpr int chains = 12, length = 1000, rounds = 2000;
  const __m512d half = _mm512_set1_pd(0.5);
  double best = 1;
  for (int round = 0; round < rounds; ++round) {
    __m512d x[chains];
    for (__m512d& y : x) y = half;
    const auto before = std::chrono::steady_clock::now();
    for (int i = 0; i < length; ++i)
      for (__m512d& y : x) y = _mm512_fmadd_pd(y, half, half);
    const std::chrono::duration<double> time = std::chrono::steady_clock::now() - before;
    for (const __m512d& y : x) asm volatile("" : : "m"(y));  // keeps the compiler from removing it
    best = std::min(best, time.count() / (chains * length));
  }
  return best;
}

}  // namespace trebsweep
