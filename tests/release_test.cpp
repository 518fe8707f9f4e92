#include "trebsweep/release.hpp"

#include "catch.hpp"

using namespace trebsweep;

namespace {

constexpr double pi = boost::math::double_constants::pi;

using Dopri5 = Steppers<double>::Dopri5;

struct Step {
  Motion<double> motion{Scene{}, {0.51, 0.58, 0.91}};
  Dopri5 stepper;
  Instant<double> from, to;

  Step(const State<double>& x, double h) {
    from = {1, x, {}};
    motion(from.x, from.dxdt, from.t);
    State<double> error;
    to = advance(stepper, motion, from, h, error);
  }

  std::optional<Instant<double>> release() { return release_between(stepper, motion, from, to); }
};

}  // namespace

TEST_CASE("find_root ends at the first place that is close enough") {
  double last = -1;
  const auto cubic = [&](double x) {
    last = x;
    return ValueAndSlope<double>{x * x * x - 0.125, 3 * x * x};
  };
  for (const double guess : {0.01, 0.3, 0.5, 0.99}) {
    find_root(cubic, 0.0, 1.0, guess, 1e-15);
    REQUIRE(last == Approx(0.5).epsilon(1e-14));
  }
}

TEST_CASE("find_root stays inside its bracket where Newton's method would leave it") {
  double last = -1;
  const auto steep = [&](double x) {  // flat but for the root's neighbourhood
    REQUIRE((0 < x && x < 1));
    last = x;
    return ValueAndSlope<double>{std::tanh(200 * (x - 0.7)),
                                 200 / std::pow(std::cosh(200 * (x - 0.7)), 2)};
  };
  find_root(steep, 0.0, 1.0, 0.1, 1e-12);
  REQUIRE(last == Approx(0.7).epsilon(1e-13));
}

TEST_CASE("A release is met to rounding, between the ends of its step") {
  Step step({pi - 0.1, 2.5, 7, 18}, 0.02);
  REQUIRE(step.to.x[phi1] > pi);
  const auto release = step.release();
  REQUIRE(release);
  CHECK(std::abs(release->x[phi1] - pi) < 2e-15);
  CHECK(release->t > step.from.t);
  CHECK(release->t < step.to.t);
  // It is the stepper's own step of that length.
  State<double> error;
  const auto again = advance(step.stepper, step.motion, step.from, release->t - step.from.t, error);
  CHECK(std::abs(again.x[phi1] - pi) < 1e-14);
}

TEST_CASE("There is no release in a step that stays below pi") {
  REQUIRE_FALSE(Step({1, 0, 3, 0}, 0.02).release());
}

TEST_CASE("An arm that passes pi and turns back within one step is released on its way up") {
  // The sling, across the arm and turning fast, throws the arm back.
  Step step({pi - 1e-3, pi / 2, 0.35, 20}, 0.05);
  REQUIRE(step.to.x[phi1] < pi);
  const auto release = step.release();
  REQUIRE(release);
  CHECK(std::abs(release->x[phi1] - pi) < 1e-14);
  CHECK(release->x[w1] > 0);
}

TEST_CASE("An arm that turns back just short of pi is not released") {
  Step step({pi - 1e-3, pi / 2, 0.1, 20}, 0.05);
  REQUIRE(step.to.x[w1] < 0);
  REQUIRE_FALSE(step.release());
}
