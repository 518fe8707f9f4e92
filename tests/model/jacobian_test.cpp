#include "trebsweep/model/jacobian.hpp"

#include "model/lagrangian.hpp"
#include "support/catch.hpp"

using namespace trebsweep;

TEST_CASE("The Jacobian equals the difference quotients of the rates, with every effect") {
  std::mt19937 random(7);
  test::for_all_effects([&]<Effects E>() {
    for (int i = 0; i < 200; ++i) {
      const auto sample = test::random_sample<E>(random);
      const auto d = jacobian(Motion<double, E>(sample.scene, sample.design), sample.x);
      using Real = long double;
      const Motion<Real, E> motion(sample.scene,
                                   {sample.design.r1, sample.design.r3, sample.design.r2});
      for (std::size_t c = 0; c < coordinates<E>; ++c) {
        const Real h = 1e-6L;
        State<Real, E> low, high, low_rates, high_rates;
        std::copy(sample.x.begin(), sample.x.end(), low.begin());
        high = low;
        low[c] -= h;
        high[c] += h;
        motion(low, low_rates, 0);
        motion(high, high_rates, 0);
        for (std::size_t r = 0; r < coordinates<E>; ++r) {
          const auto quotient = static_cast<double>((high_rates[r] - low_rates[r]) / (2 * h));
          const double value = d(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(c));
          CHECK(value == Approx(quotient).epsilon(1e-6).margin(1e-6));
        }
      }
    }
  });
}
