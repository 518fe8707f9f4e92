#include "trebsweep/model/jacobian.hpp"

#include "model/lagrangian.hpp"
#include "support/catch.hpp"

using namespace trebsweep;

namespace {

template <Effects E>
void check_jacobian(const test::Sample<E>& sample, double sliding) {
  auto motion = test::motion(sample);
  motion.set_sliding(sliding);
  const auto d = jacobian(motion, sample.x);
  using Real = long double;
  Motion<Real, E> precise(sample.scene, {sample.design.r1, sample.design.r3, sample.design.r2});
  precise.set_sliding(sliding);
  for (std::size_t c = 0; c < coordinates<E>; ++c) {
    const Real h = 1e-6L;
    State<Real, E> low, high, low_rates, high_rates;
    std::copy(sample.x.begin(), sample.x.end(), low.begin());
    high = low;
    low[c] -= h;
    high[c] += h;
    precise(low, low_rates, 0);
    precise(high, high_rates, 0);
    for (std::size_t r = 0; r < coordinates<E>; ++r) {
      const auto quotient = static_cast<double>((high_rates[r] - low_rates[r]) / (2 * h));
      const double value = d(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(c));
      CHECK(value == Approx(quotient).epsilon(1e-6).margin(1e-6));
    }
  }
}

}  // namespace

TEST_CASE("The Jacobian equals the difference quotients of the rates, with every effect") {
  std::mt19937 random(7);
  test::for_all_effects([&]<Effects E>() {
    if constexpr (E.pivot)
      for (int i = 0; i < 200; ++i) {
        const auto sample = test::random_sample<E>(random);
        check_jacobian(sample, 1);
        if (E.trough) check_jacobian(sample, 0);
      }
  });
}
