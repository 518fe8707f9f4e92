#include "trebsweep/ode/event.hpp"

#include <numbers>

#include "support/catch.hpp"

using namespace trebsweep;

namespace {

constexpr double pi = std::numbers::pi;

struct Step {
  Motion<double> motion{Scene{}, {0.51, 0.58, 0.91}};
  Dopri5<double> stepper;
  Instant<double> from, to;

  Step(const State<double>& x, double h) {
    from = instant(motion, 1.0, x);
    State<double> error;
    advance(stepper, motion, from, h, to, error);
  }

  Instant<double> release() {
    return event_between(AngleEvent<double>{false, pi}, stepper, motion, from, to);
  }
  Instant<double> turn() {
    const double start = from.x[w1], end = to.x[w1];
    const auto slowing = [](const Instant<double>& at) { return -at.x[w1]; };
    const Bracket<double, Effects{}> bracket{from, to.t - from.t,         0,
                                             1,    start / (start - end), start - end};
    return locate_by_secants(bracket, stepper, motion, slowing, 1e-8);
  }
};

}  // namespace

TEST_CASE("find_root converges to the root") {
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

TEST_CASE("find_root stays inside the bracket where Newton's method would leave it") {
  double last = -1;
  const auto steep = [&](double x) {  // flat except near the root
    REQUIRE((0 < x && x < 1));
    last = x;
    return ValueAndSlope<double>{std::tanh(200 * (x - 0.7)),
                                 200 / std::pow(std::cosh(200 * (x - 0.7)), 2)};
  };
  find_root(steep, 0.0, 1.0, 0.1, 1e-12);
  REQUIRE(last == Approx(0.7).epsilon(1e-13));
}

TEST_CASE("Every lane finds its own root") {
  using T = Pack<1>;
  for (std::size_t lane = 0; lane < Lanes<T>::count; ++lane) {
    T wanted = 0.5, found;
    set_lane(wanted, lane, 0.9);
    const auto cube = [&](const T& x) {
      found = x;
      return ValueAndSlope<T>{x * x * x - wanted * wanted * wanted, 3 * x * x};
    };
    find_root(cube, T(0), T(1), T(0.5), T(1e-15));
    for (std::size_t i = 0; i < Lanes<T>::count; ++i)
      REQUIRE(get_lane(found, i) == Approx(get_lane(wanted, i)).epsilon(1e-14));
    REQUIRE(get_lane(found, (lane + 1) % Lanes<T>::count) == 0.5);
  }
}

TEST_CASE("A release is located to rounding error, within its step") {
  for (const double h : {0.02, 0.1, 0.15}) {
    Step step({pi - 0.1, 2.5, 7, 18}, h);
    REQUIRE(step.to.x[phi1] > pi);
    const auto release = step.release();
    CHECK(std::abs(release.x[phi1] - pi) < 2e-15);
    CHECK(release.t > step.from.t);
    CHECK(release.t < step.to.t);
    // It is the end of a step of that length.
    Instant<double> again;
    State<double> error;
    advance(step.stepper, step.motion, step.from, release.t - step.from.t, again, error);
    for (std::size_t i = 0; i < 4; ++i) CHECK(again.x[i] == Approx(release.x[i]).margin(1e-11));
  }
}

TEST_CASE(
    "An arm that passes phi1 = pi and turns back within one step is released when it first "
    "passes") {
  // The sling, perpendicular to the arm and rotating fast, throws the arm back.
  Step step({pi - 1e-3, pi / 2, 0.35, 20}, 0.05);
  REQUIRE(step.to.x[phi1] < pi);
  step.to = step.turn();
  CHECK(std::abs(step.to.x[w1]) < 1e-12);
  REQUIRE(step.to.x[phi1] > pi);
  const auto release = step.release();
  CHECK(std::abs(release.x[phi1] - pi) < 1e-14);
  CHECK(release.x[w1] > 0);
}

TEST_CASE("An arm that turns back just before phi1 = pi has its turning point below pi") {
  Step step({pi - 1e-3, pi / 2, 0.1, 20}, 0.05);
  REQUIRE(step.to.x[w1] < 0);
  CHECK(step.turn().x[phi1] < pi);
  CHECK(step.turn().x[phi1] > step.from.x[phi1]);
}
