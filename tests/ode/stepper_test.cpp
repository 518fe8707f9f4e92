#include "trebsweep/ode/stepper.hpp"

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <iterator>
#include <vector>

#include "support/catch.hpp"
#include "trebsweep/model/start.hpp"
#include "trebsweep/ode/steppers.hpp"

using namespace trebsweep;

namespace {

constexpr double end_time = 0.5;

std::vector<std::string_view> pack_steppers() {
  std::vector<std::string_view> names;
  std::ranges::copy_if(stepper_names, std::back_inserter(names), is_for_packs);
  return names;
}

/// The state of the paper's optimum after half a second in equal steps.
template <class Stepper, class T>
State<T> integrate(int steps) {
  const Design<T> design{T(0.51), T(0.58), T(0.91)};
  const Motion<T> motion(Scene{}, design);
  Stepper stepper;
  auto now = instant(motion, T(0), start<T>(Scene{}, design));
  Instant<T> to;
  State<T> error;
  for (int i = 0; i < steps; ++i, now = to)
    advance(stepper, motion, now, T(T(end_time) / steps), to, error);
  return now.x;
}

template <class T>
T distance(const State<T>& a, const State<std::type_identity_t<T>>& b) {
  using std::abs;
  T largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, T(abs(T(a[i] - b[i]))));
  return largest;
}

/// log2 of the error's ratio between `steps` and twice as many.
template <template <class, Effects> class Stepper>
double observed_order(int steps) {
  using std::log2;
  using Quad = boost::multiprecision::cpp_bin_float_quad;
  using S = Stepper<Quad, Effects{}>;
  static const auto truth = integrate<Fehlberg78<Quad>, Quad>(1000);
  return static_cast<double>(log2(Quad(distance(integrate<S, Quad>(steps), truth) /
                                       distance(integrate<S, Quad>(2 * steps), truth))));
}

/// Evaluations of the right-hand side in a step after the first one, which has the rates at its
/// start from the last step.
template <class Stepper>
unsigned evaluations_of_step() {
  using X = typename Stepper::state_type;
  Stepper stepper;
  unsigned calls = 0;
  const auto system = [&](const X& x, X& dxdt, double) {
    dxdt = x;
    ++calls;
  };
  X x{}, dxdt{}, end{}, end_rates{}, error{};
  if constexpr (std::is_same_v<typename Stepper::stepper_category,
                               odeint::explicit_error_stepper_fsal_tag>) {
    stepper.do_step(system, x, dxdt, 0.0, end, end_rates, 0.1, error);
    return calls;
  } else {
    if constexpr (is_adaptive<Stepper>)
      stepper.do_step(system, x, dxdt, 0.0, end, 0.1, error);
    else
      stepper.do_step(system, x, dxdt, 0.0, end, 0.1);
    return calls + 1;  // at the end
  }
}

}  // namespace

TEST_CASE("Each stepper converges at its order") {
  CHECK(observed_order<Euler>(800) == Approx(1).margin(0.1));
  CHECK(observed_order<ModifiedMidpoint>(400) == Approx(2).margin(0.1));
  CHECK(observed_order<RungeKutta4>(80) == Approx(4).margin(0.1));
  CHECK(observed_order<CashKarp54>(80) == Approx(5).margin(0.1));
  CHECK(observed_order<Dopri5>(80) == Approx(5).margin(0.1));
  CHECK(observed_order<Fehlberg78>(80) == Approx(8).margin(0.1));
  CHECK(observed_order<Vern7>(80) == Approx(7).margin(0.1));
  CHECK(observed_order<Vern8>(80) == Approx(8).margin(0.1));
}

TEST_CASE("A step ends with the rates at its end") {
  const Motion<double> motion(Scene{}, {0.51, 0.58, 0.91});
  for (const auto name : pack_steppers())
    with_pack_stepper(
        name, [&]<template <class, Effects = Effects{}> class Stepper>() {
          Stepper<double> stepper;
          Instant<double> to;
          State<double> error;
          advance(stepper, motion, instant(motion, 0.25, {0.4, -0.3, 1, -2}), 0.125, to, error);
          const auto same = instant(motion, 0.375, to.x);
          CHECK(to.t == 0.375);
          // An adaptive stepper integrates the directions, up to its error.
          const double margin = is_adaptive<Stepper<double>> ? 1e-4 : 0;
          CHECK(distance(to.directions, same.directions) <= margin);
          CHECK(distance(to.dxdt, same.dxdt) <= 100 * margin);
        });
}

TEST_CASE("The error estimate of an adaptive stepper converges at its order") {
  using Real =
      long double;  // at steps short enough for the order, fehlberg78 is below double's rounding
  const Motion<Real> motion(Scene{}, {Real(0.51), Real(0.58), Real(0.91)});
  for (const auto name : pack_steppers())
    with_pack_stepper(
        name, [&]<template <class, Effects = Effects{}> class Stepper>() {
          if constexpr (is_adaptive<Stepper<Real>>) {
            Stepper<Real> stepper;
            const auto from = instant<Real>(motion, 0, {Real(0.4), Real(-0.3), 1, -2});
            Instant<Real> to;
            State<Real> error{}, half{};
            advance(stepper, motion, from, Real(0.02), to, error);
            advance(stepper, motion, from, Real(0.01), to, half);
            const auto order =
                static_cast<double>(std::log2(distance(error, {}) / distance(half, {})));
            CHECK(order == Approx(stepper.error_order() + 1).margin(0.25));
          }
        });
}

TEST_CASE("An unknown stepper is an error") {
  const auto none = []<template <class, Effects = Effects{}> class>(){};
  REQUIRE_THROWS_AS(with_pack_stepper("leapfrog", none), std::logic_error);
  REQUIRE_THROWS_AS(with_single_stepper("leapfrog", none), std::logic_error);
  REQUIRE_THROWS_AS(with_single_stepper("euler", none), std::logic_error);
}

TEST_CASE("The registry describes the steppers") {
  for (const StepperInfo& info : stepper_info) {
    const auto check = [&]<template <class, Effects = Effects{}> class Stepper>() {
      const auto stepper = make_stepper<Stepper<double>>(Solver());
      CHECK(info.follows_tolerance == is_adaptive<Stepper<double>>);
      CHECK((info.order == 0) == is_own_controller<Stepper<double>>);
      if (info.order > 0) CHECK(info.order == stepper.order());
      if constexpr (!HasStep<Stepper<double>, double, Effects{}>)
        CHECK(info.stages == evaluations_of_step<Stepper<double>>());
    };
    info.for_packs ? with_pack_stepper(info.name, check) : with_single_stepper(info.name, check);
  }
}

TEST_CASE("The first extrapolated step of a swing does not depend on earlier swings") {
  const Solver solver{.tolerance = 1e-9};
  const auto first_step = [](auto& stepper, const Motion<double>& motion, double h, auto& to) {
    const auto from = instant(motion, 0.0, {0.4, -0.3, 1, -2});
    return stepper.try_step(motion, from, h, to);
  };
  const Motion<double> motion(Scene{}, {0.51, 0.58, 0.91}), other(Scene{}, {0.3, 1.5, 0.2});
  for (const double h : {0.001, 0.01, 0.05, 0.2}) {
    BulirschStoer<double> fresh(solver), used(solver);
    Instant<double> expected, to;
    const auto before = first_step(used, other, h, to);
    // Odeint's stepper keeps its order and step size if it is given the step that it proposed.
    const auto wanted = first_step(fresh, motion, before.next, expected);
    const auto got = first_step(used, motion, before.next, to);
    CHECK(got.accepted == wanted.accepted);
    CHECK(got.next == wanted.next);
    CHECK(to.x == expected.x);
  }
}
