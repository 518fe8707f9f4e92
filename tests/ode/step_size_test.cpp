#include "trebsweep/ode/step_size.hpp"

#include <array>

#include "support/catch.hpp"

using namespace trebsweep;

TEST_CASE("A NaN at the end of a step or in its error rejects the step") {
  Instant<double> from{}, to{};
  to.t = 0.1;
  State<double> error{};
  const auto is_good = [&] {
    const auto ratio = error_ratio(from, to, error, 0.1, 1e-9);
    return ratio.error <= ratio.allowed;
  };
  CHECK(is_good());
  to.x[phi2] = std::nan("");
  CHECK_FALSE(is_good());
  to.x[phi2] = 0;
  to.dxdt[w1] = std::nan("");
  CHECK_FALSE(is_good());
  to.dxdt[w1] = std::numeric_limits<double>::infinity();
  CHECK_FALSE(is_good());
  to.dxdt[w1] = 0;
  error = {1e-10, std::nan(""), 1e-10, 0};
  CHECK_FALSE(is_good());
}

TEST_CASE("The error ratio is the largest ratio of error to allowed error over the coordinates") {
  const Instant<double> from{0, {1, 0, 0, 3}, {}, {0, 2, 0, 0}}, to{};
  for (std::size_t i = 0; i < 4; ++i) {
    State<double> error{1e-12, 1e-12, 1e-12, 1e-12};
    error[i] = -1e-9;
    const std::array scale{2.0, 2.0, 1.0, 4.0};  // 1 + |x| + |h dxdt|
    const auto ratio = error_ratio(from, to, error, 0.5, 1e-9);
    CHECK(ratio.error / ratio.allowed == Approx(1 / scale[i]));
  }
}

TEST_CASE("The step factor aims at the tolerance and stays between 1/5 and 5") {
  const auto factor = [](double ratio, int order) {
    return step_factor(ErrorRatio<double>{ratio, 1}, order);
  };
  CHECK(factor(1, 4) == Approx(0.9));
  CHECK(factor(1.0 / 32, 4) == Approx(1.8));
  CHECK(factor(1, 7) == Approx(0.8));
  CHECK(factor(0, 4) == 5);
  CHECK(factor(1e9, 4) == 0.2);
  CHECK(factor(std::numeric_limits<double>::infinity(), 4) == 0.2);
  CHECK(factor(std::nan(""), 4) == 0.2);
}
