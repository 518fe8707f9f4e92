#pragma once

#include <array>
#include <cstddef>
#include <tuple>
#include <utility>

namespace trebsweep {

// Replacements for Odeint's default_operations and array_algebra with the same results. Once a step
// is inlined, the compiler sees constant factors and unrolled loops.

/// Linear combinations that omit terms whose factor is zero (a third of fehlberg78's) and products
/// with one.
struct Operations {
  template <class Factor, std::size_t N>
  struct Sum {
    std::array<Factor, N> factors;

    template <class... Factors>
    Sum(const Factors&... f) : factors{Factor(f)...} {}

    template <class T, class... Terms>
    void operator()(T& sum, const T& first, const Terms&... terms) const {
      T s = factors[0] == Factor(1) ? first : T(T(factors[0]) * first);
      std::size_t i = 0;
      const auto add = [&](const T& term) {
        if (factors[++i] != Factor(0)) s += T(factors[i]) * term;
      };
      (add(terms), ...);
      sum = s;
    }
  };
  template <class Factor, class...>
  using scale_sum2 = Sum<Factor, 2>;
  template <class Factor, class...>
  using scale_sum3 = Sum<Factor, 3>;
  template <class Factor, class...>
  using scale_sum4 = Sum<Factor, 4>;
  template <class Factor, class...>
  using scale_sum5 = Sum<Factor, 5>;
  template <class Factor, class...>
  using scale_sum6 = Sum<Factor, 6>;
  template <class Factor, class...>
  using scale_sum7 = Sum<Factor, 7>;
  template <class Factor, class...>
  using scale_sum8 = Sum<Factor, 8>;
  template <class Factor, class...>
  using scale_sum9 = Sum<Factor, 9>;
  template <class Factor, class...>
  using scale_sum10 = Sum<Factor, 10>;
  template <class Factor, class...>
  using scale_sum11 = Sum<Factor, 11>;
  template <class Factor, class...>
  using scale_sum12 = Sum<Factor, 12>;
  template <class Factor, class...>
  using scale_sum13 = Sum<Factor, 13>;
  template <class Factor, class...>
  using scale_sum14 = Sum<Factor, 14>;
};

/// Applies an operation, the last argument, to corresponding elements of arrays.
struct Algebra {
  template <class... S>
  static void for_each2(S&&... s) {
    for_each_element(std::tie(s...));
  }
  template <class... S>
  static void for_each3(S&&... s) {
    for_each_element(std::tie(s...));
  }
  template <class... S>
  static void for_each4(S&&... s) {
    for_each_element(std::tie(s...));
  }
  template <class... S>
  static void for_each5(S&&... s) {
    for_each_element(std::tie(s...));
  }
  template <class... S>
  static void for_each6(S&&... s) {
    for_each_element(std::tie(s...));
  }
  template <class... S>
  static void for_each7(S&&... s) {
    for_each_element(std::tie(s...));
  }
  template <class... S>
  static void for_each8(S&&... s) {
    for_each_element(std::tie(s...));
  }
  template <class... S>
  static void for_each9(S&&... s) {
    for_each_element(std::tie(s...));
  }
  template <class... S>
  static void for_each10(S&&... s) {
    for_each_element(std::tie(s...));
  }
  template <class... S>
  static void for_each11(S&&... s) {
    for_each_element(std::tie(s...));
  }
  template <class... S>
  static void for_each12(S&&... s) {
    for_each_element(std::tie(s...));
  }
  template <class... S>
  static void for_each13(S&&... s) {
    for_each_element(std::tie(s...));
  }
  template <class... S>
  static void for_each14(S&&... s) {
    for_each_element(std::tie(s...));
  }
  template <class... S>
  static void for_each15(S&&... s) {
    for_each_element(std::tie(s...));
  }

 private:
  template <class X, class... S>
  static void for_each_element(const std::tuple<X&, S&...>& s) {
    constexpr auto elements = std::make_index_sequence<std::tuple_size_v<X>>();
    constexpr auto arrays = std::make_index_sequence<sizeof...(S)>();
    const auto& op = std::get<sizeof...(S)>(s);
    const auto at = [&]<std::size_t I, std::size_t... J>(std::index_sequence<I>,
                                                         std::index_sequence<J...>) {
      op(std::get<I>(std::get<J>(s))...);
    };
    [&]<std::size_t... I>(std::index_sequence<I...>) {
      (at(std::index_sequence<I>(), arrays), ...);
    }
    (elements);
  }
};

}  // namespace trebsweep
