// Compiled once for each instruction set.

#include "trebsweep/simd/pack.hpp"

#include <cmath>
#include <cstring>
#include <random>

#include "support/catch.hpp"
#include "trebsweep/ode/stepper.hpp"
#include "trebsweep/swing/swing.hpp"
#include "trebsweep/swing/swings.hpp"

// The kernel library hides its own.
template trebsweep::Flight<trebsweep::Pack<2>> trebsweep::flight(const Scene&,
                                                                 const Vector<Pack<2>>&,
                                                                 const Vector<Pack<2>>&);
template trebsweep::ValueAndSlope<trebsweep::Pack<2>> trebsweep::range_and_slope(
    const Scene&, const Vector<Pack<2>>&, const Vector<Pack<2>>&, const Vector<Pack<2>>&, double);

using namespace trebsweep;

namespace {

using One = Pack<1>;

/// |x - truth| in units of the last place of a double of that size.
double ulps(double x, long double truth) {
  int exponent;
  std::frexp(static_cast<double>(truth), &exponent);
  return static_cast<double>(std::abs(x - truth)) / std::ldexp(1, exponent - 53);
}

std::vector<Design<double>> some_designs() {
  std::vector<Design<double>> designs;
  for (int i = 0; i < 200; ++i)
    designs.push_back({0.51 + 0.004 * i, 0.3 + 0.0011 * i, 1.1 - 0.005 * i});
  return designs;
}

/// The outcomes of some_designs() in a scene with the effects E, in packs T.
template <class Stepper, class T, Effects E = Effects{}>
std::vector<Outcome<double, E>> integrate_all(const Solver& solver, const Scene& scene = {}) {
  const auto designs = some_designs();
  std::vector<Outcome<double, E>> outcomes(designs.size());
  std::size_t at = 0;
  const auto next = [&](Design<double>& design) {
    if (at == designs.size()) return false;
    design = designs[at++];
    return true;
  };
  const auto done = [&](std::uint64_t number, const auto& o) { outcomes[number] = o; };
  const auto stepper = any_stepper<T, E, Stepper>();
  Swings<T, E, decltype(next), decltype(done)>(scene, solver, stepper, {}, {}, next, done).run();
  return outcomes;
}

template <Effects E>
bool same_bits(const Outcome<double, E>& a, const Outcome<double, E>& b) {
  return a.status == b.status && std::memcmp(&a.t, &b.t, 8) == 0 && a.steps == b.steps &&
         std::memcmp(a.x.data(), b.x.data(), sizeof(a.x)) == 0 &&
         std::memcmp(&a.speed, &b.speed, 8) == 0;
}

/// Requires both to be bitwise the same, and returns the number of releases.
template <Effects E>
std::size_t require_same_bits(const std::vector<Outcome<double, E>>& one,
                              const std::vector<Outcome<double, E>>& two) {
  std::size_t released = 0;
  for (std::size_t i = 0; i < one.size(); ++i) {
    INFO(i << " " << one[i].t << " " << two[i].t << " status " << static_cast<int>(one[i].status)
           << static_cast<int>(two[i].status));
    REQUIRE(same_bits(one[i], two[i]));
    released += one[i].status == Status::released;
  }
  return released;
}

}  // namespace

TEST_CASE("Sine and cosine are within 2 ULP") {
  std::mt19937_64 random(1);
  double worst = 0;
  const auto check = [&](double x) {
    const auto [sin_x, cos_x] = sin_cos(One(x));
    worst = std::max({worst, ulps(sin_x[0], std::sin(static_cast<long double>(x))),
                      ulps(cos_x[0], std::cos(static_cast<long double>(x)))});
  };
  const double eighth = boost::math::double_constants::pi / 8;
  for (const double range : {0.5, 10.0, 1e5})
    for (int i = 0; i < 3000; ++i) {
      const double x = std::uniform_real_distribution<double>(-range, range)(random);
      const double near = std::uniform_real_distribution<double>(-0.01, 0.01)(random);
      check(x);
      check(std::round(x / eighth) * eighth + near * near);   // near the zeros
      check((std::floor(x / eighth) + 0.5) * eighth + near);  // where the table index changes
    }
  CHECK(worst <= 2);
  CHECK(worst > 0.4);
}

TEST_CASE("Sine and cosine are NaN if the argument is not finite") {
  for (const double x : {std::numeric_limits<double>::infinity(), std::nan("")}) {
    CHECK(std::isnan(sin_cos(One(x)).sin[0]));
    CHECK(std::isnan(sin_cos(One(x)).cos[0]));
  }
}

TEST_CASE("A rough power has a relative error below 2 %") {
  for (double a = 1e-12; a < 1e12; a *= 1.37)
    for (const double e : {-0.2, -0.125, 1.0 / 9})
      CHECK(rough_power(One(a), One(3.0), e)[0] == Approx(std::pow(a / 3, e)).epsilon(0.02));
}

TEST_CASE("A product followed by an addition is one fused multiply-add where the machine has it") {
  const double a = 1 + 0x1p-30, b = 1 - 0x1p-30;
  const double exact = -0x1p-60;  // a b - 1; rounded before the subtraction it is 0
  const double expected = has_fused_multiply_add ? exact : 0;
  CHECK((One(a) * One(b) - One(1))[0] == expected);
  CHECK((One(1) - One(a) * One(b))[0] == -expected);
}

TEST_CASE("Outcomes are bitwise the same in packs of one and of two registers") {
  // One stepper of each kind; more would take minutes to compile.
  const auto check = []<template <class, Effects = Effects{}> class Stepper>(Release release) {
    using Two = Pack<2>;
    Solver solver;
    solver.release = release;
    solver.max_time = 0.75;  // some are released, some are not
    const auto one = integrate_all<Stepper<One>, One>(solver);
    const auto two = integrate_all<Stepper<Two>, Two>(solver);
    const std::size_t released = require_same_bits(one, two);
    CHECK(released > 0);
    CHECK(released < one.size());
  };
  for (const Release release : {Release::crossing, Release::window}) {
    check.operator()<Euler>(release);
    check.operator()<Dopri5>(release);
  }
}

TEST_CASE(
    "Outcomes with hanger and trough are bitwise the same in packs of one and of two registers by "
    "every rule of release") {
  constexpr Effects E{.hanger = true, .trough = true};
  Scene scene;
  scene.counterweight_hanger = 0.3;
  scene.start_angle = 0.6;
  scene.trough = true;
  scene.trough_height = 0.9;
  const auto check = [&]<template <class, Effects = Effects{}> class Stepper>(Release release) {
    using Two = Pack<2>;
    Solver solver;
    solver.release = release;
    solver.pin_angle = 0.6;
    solver.max_time = 0.75;
    const auto one = integrate_all<Stepper<One, E>, One, E>(solver, scene);
    const auto two = integrate_all<Stepper<Two, E>, Two, E>(solver, scene);
    const std::size_t released = require_same_bits(one, two);
    CHECK(released > 0);
    CHECK(released < one.size());
  };
  for (const Release release :
       {Release::crossing, Release::pin, Release::farthest, Release::fastest}) {
    check.operator()<RungeKutta4>(release);
    check.operator()<Dopri5>(release);
  }
}

TEST_CASE("Lanes agree with the same swing in scalars") {
  for (const auto name : stepper_names) {
    if (!is_for_packs(name)) continue;
    Solver solver;
    solver.stepper = name;
    const auto lanes = with_pack_stepper(
        name, [&]<template <class, Effects = Effects{}> class Stepper>() {
          return integrate_all<Stepper<One>, One>(solver);
        });
    const auto designs = some_designs();
    for (std::size_t i = 0; i < lanes.size(); ++i) {
      const auto scalar = swing<general_effects[0]>(Scene{}, designs[i], solver);
      CHECK(lanes[i].status == scalar.status);
      CHECK(lanes[i].speed == Approx(scalar.speed).margin(1e-8));
      CHECK(lanes[i].t == Approx(scalar.t).margin(1e-9));
    }
  }
}
