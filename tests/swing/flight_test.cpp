#include "trebsweep/swing/flight.hpp"

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <cstring>
#include <random>
#include <vector>

#include "support/catch.hpp"

#if __has_include(<gsl/gsl_odeiv2.h>)
#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>
#endif

using namespace trebsweep;

namespace {

using Quad = boost::multiprecision::cpp_bin_float_quad;

constexpr double fulcrum_height = 4;

/// A scene with a given drag constant, 1/m.
Scene scene_with_drag(double k, double wind = 0) {
  Scene scene;
  scene.fulcrum_height = fulcrum_height;
  scene.projectile_mass = 10;
  scene.projectile_diameter = 1;
  scene.wind = wind;
  scene.air_density *= k / drag_constant(scene);
  return scene;
}

struct Throw {
  Vector<double> position, velocity;
};

std::vector<Throw> random_throws(int n) {
  std::mt19937_64 random(1);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  std::vector<Throw> throws;
  for (int i = 0; i < n; ++i)
    throws.push_back({{uniform(-6, 6), uniform(-4, 8)}, {uniform(-20, 50), uniform(-30, 40)}});
  return throws;
}

template <class T>
Vector<T> convert(const Vector<double>& v) {
  return {T(v.x), T(v.y)};
}

template <class T>
std::vector<T> values(const Flight<T>& f) {
  return {f.range, f.time, f.impact_speed, f.apex};
}

/// A throw straight up from the ground and back, in closed form (v m/s, k 1/m, g m/s^2).
Flight<long double> vertical_throw(long double v, long double k, long double g) {
  const long double terminal = std::sqrt(g / k), apex = std::log1p(k * v * v / g) / (2 * k);
  const long double up = std::atan(v / terminal) * terminal / g;
  const long double impact = terminal * std::sqrt(-std::expm1(-2 * k * apex));
  const long double down = std::atanh(impact / terminal) * terminal / g;
  return {0, up + down, impact, apex};
}

/// The error of the position, m, after n equal steps of a flight of 4 s.
double error_of_steps(int n) {
  const FlightEquations<Quad> equations(scene_with_drag(0.01, 5));
  const auto fly = [&](int steps) {
    FlightState<Quad, 4> s{0, 0, 40, 30};
    for (int i = 0; i < steps; ++i) s = advance_flight(equations, s, Quad(4) / steps).to;
    return s;
  };
  static const auto accurate = fly(1024);
  const auto s = fly(n);
  return static_cast<double>(abs(Quad(s[0] - accurate[0])) + abs(Quad(s[1] - accurate[1])));
}

/// The derivative of the range by central differences.
Quad range_difference(const Scene& scene, const Throw& t, const Vector<double>& change) {
  const Quad d = 1e-5;
  const auto range = [&](const Quad& factor) {
    const auto v = convert<Quad>(t.velocity) + factor * convert<Quad>(change);
    return flight(scene, convert<Quad>(t.position), v).range;
  };
  return (8 * (range(d) - range(-d)) - (range(2 * d) - range(-2 * d))) / (12 * d);
}

/// Throws in the lanes of a pack, beginning with number `first` and starting over at the end.
template <class T>
struct PackedThrows {
  Vector<T> position, velocity;

  PackedThrows(const std::vector<Throw>& throws, std::size_t first) {
    for (std::size_t i = 0; i < Lanes<T>::count; ++i) {
      const Throw& t = throws[(first + i) % throws.size()];
      set_lane(position.x, i, t.position.x);
      set_lane(position.y, i, t.position.y);
      set_lane(velocity.x, i, t.velocity.x);
      set_lane(velocity.y, i, t.velocity.y);
    }
  }
};

/// The bits of all results of the throw in one lane.
template <class T>
std::array<double, 6> results_of_lane(const Scene& scene, const PackedThrows<T>& p,
                                      std::size_t lane) {
  const auto f = flight(scene, p.position, p.velocity);
  const auto r = range_and_slope(scene, p.position, p.velocity, p.velocity, 1e-10);
  return {f.range[lane], f.time[lane],  f.impact_speed[lane],
          f.apex[lane],  r.value[lane], r.slope[lane]};
}

}  // namespace

TEST_CASE("Without drag a flight is a parabola") {
  Scene scene;
  scene.fulcrum_height = fulcrum_height;
  scene.gravity = 10;
  // Up 20 m in 2 s from a height of 5 m, down 25 m in sqrt(5) s.
  const auto f = flight<double>(scene, {-3, 1}, {7, 20});
  CHECK(f.apex == Approx(25).epsilon(1e-15));
  CHECK(f.time == Approx(2 + std::sqrt(5)).epsilon(1e-15));
  CHECK(f.range == Approx(-3 + 7 * f.time).epsilon(1e-15));
  CHECK(f.impact_speed == Approx(std::sqrt(49 + 500)).epsilon(1e-15));
  const auto down = flight<double>(scene, {-3, 1e-9 - 4}, {7, -20});
  CHECK(down.time == Approx(5e-11).epsilon(1e-6));  // 1e-9 - 4 is rounded
  CHECK(down.apex == Approx(1e-9).epsilon(1e-6));
}

TEST_CASE("A tiny projectile flies as without drag") {
  Scene scene, tiny;
  tiny.projectile_diameter = 1e-6;
  for (const Throw& t : random_throws(50)) {
    if (t.position.y < -scene.fulcrum_height) continue;
    const auto expected = values(flight(scene, t.position, t.velocity));
    const auto found = values(flight(tiny, t.position, t.velocity));
    for (std::size_t i = 0; i < 4; ++i) CHECK(std::abs(found[i] - expected[i]) < 1e-9);
  }
}

TEST_CASE("A throw straight up agrees with its closed form at any scale") {
  for (const double scale : {1e-6, 1.0, 1e6})
    for (const double v : {1.0, 30.0, 300.0}) {
      // Lengths times the scale and times as they are.
      Scene scene = scene_with_drag(0.01 / scale);
      scene.gravity *= scale;
      const auto expected = vertical_throw(v * scale, drag_constant(scene), scene.gravity);
      const auto check = [&]<class T>(T) {
        const auto f = flight<T>(scene, {T(0), T(-fulcrum_height)}, {T(0), T(v * scale)});
        CHECK(f.range == 0);
        CHECK(static_cast<double>(f.time / expected.time) == Approx(1).epsilon(1e-11));
        CHECK(static_cast<double>(f.impact_speed / expected.impact_speed) ==
              Approx(1).epsilon(1e-11));
        CHECK(static_cast<double>(f.apex / expected.apex) == Approx(1).epsilon(1e-11));
      };
      check(double());
      check(static_cast<long double>(0));
    }
}

TEST_CASE("A wind as fast as the projectile carries it along") {
  const double v = 30, wind = 12, k = 0.01;
  const Scene scene = scene_with_drag(k, wind);
  const auto expected = vertical_throw(v, drag_constant(scene), scene.gravity);
  const auto f = flight<double>(scene, {-3, -fulcrum_height}, {wind, v});
  CHECK(f.time == Approx(double(expected.time)).epsilon(1e-11));
  CHECK(f.apex == Approx(double(expected.apex)).epsilon(1e-11));
  CHECK(f.range == Approx(-3 + wind * double(expected.time)).epsilon(1e-11));
  CHECK(f.impact_speed == Approx(std::hypot(wind, double(expected.impact_speed))).epsilon(1e-11));
}

TEST_CASE("With almost no gravity a horizontal throw agrees with its closed form") {
  // Falls less than a micrometre in 3 s, at less than 1e-8 of the horizontal speed.
  const double v = 30, k = 0.01;
  Scene scene = scene_with_drag(k);
  scene.gravity = 1e-7;
  scene.fulcrum_height = 5e-7;
  const auto f = flight<double>(scene, {0, 0}, {v, 0});
  CHECK(f.time > 3);
  CHECK(f.range == Approx(std::log1p(k * v * f.time) / k).epsilon(1e-13));
  CHECK(f.impact_speed == Approx(v / (1 + k * v * f.time)).epsilon(1e-13));
  CHECK(f.apex == scene.fulcrum_height);
}

TEST_CASE("A flight through air has the order 8") {
  for (const int n : {64, 128}) {
    const double order = std::log2(error_of_steps(n) / error_of_steps(2 * n));
    INFO(n << " steps: " << error_of_steps(n));
    CHECK(order > 7.5);
    CHECK(order < 9);
  }
}

TEST_CASE("The results in double precision agree with wider types to 1e-12") {
  const auto check = [](const Scene& scene, const Throw& t) {
    const auto narrow = values(flight(scene, t.position, t.velocity));
    const auto wide = values(flight(scene, convert<Quad>(t.position), convert<Quad>(t.velocity)));
    for (std::size_t i = 0; i < 4; ++i)
      CHECK(narrow[i] == Approx(static_cast<double>(wide[i])).epsilon(1e-12));
  };
  for (const Throw& t : random_throws(5)) check(scene_with_drag(0.01, 5), t);
  // At rest in the air for a moment, or nearly so.
  for (const double vx : {2.5, 2.5001, 2.507, 2.6})
    check(scene_with_drag(0.001, 2.5), {{-3.5, 3}, {vx, 33}});
}

TEST_CASE("The slope of the range is its derivative, with and without drag") {
  for (const double k : {0.0, 0.01})
    for (const Throw& t : random_throws(5))
      for (const Vector<double>& change : {Vector<double>{1, 0}, {0, 1}, {-60, 25}}) {
        const Scene scene = scene_with_drag(k, k > 0 ? 5 : 0);
        const auto found = range_and_slope(scene, t.position, t.velocity, change, 1e-12);
        CHECK(found.value == Approx(flight(scene, t.position, t.velocity).range).epsilon(1e-11));
        const auto expected = static_cast<double>(range_difference(scene, t, change));
        CHECK(found.slope == Approx(expected).epsilon(1e-8));
      }
}

TEST_CASE(
    "The slope is finite for a projectile at rest in the air, and zero for one on the ground") {
  const Scene scene = scene_with_drag(0.01, 5);
  const auto found = range_and_slope<double>(scene, {0, 0}, {5, 0}, {1, 1}, 1e-12);
  CHECK(std::isfinite(found.slope));
  CHECK(found.slope > 0);
  for (const double diameter : {0.0, 1.0}) {
    Scene ground = scene;
    ground.projectile_diameter = diameter;
    const auto r = range_and_slope<double>(ground, {2, -fulcrum_height}, {3, 0}, {1, 1}, 1e-12);
    CHECK(r.value == 2);
    CHECK(r.slope == 0);
  }
}

TEST_CASE("A lane has the same bits among any other throws, in packs of any size") {
  const Scene scene = scene_with_drag(0.01, 5);
  auto throws = random_throws(16);
  throws[3].position.y = -5;                   // below the ground
  throws[5].velocity.x = std::nan("");         // never integrated
  throws[7] = {{0, -fulcrum_height}, {3, 0}};  // on it
  throws[9].velocity = {1e5, 1e5};             // many steps
  const std::size_t n = throws.size();
  for (std::size_t i = 0; i < n; ++i) {
    const std::vector<Throw> alone{throws[i]};
    const auto expected = results_of_lane(scene, PackedThrows<Pack<1>>(alone, 0), 0);
    const auto check = [&]<class T>(T) {
      for (std::size_t lane = 0; lane < Lanes<T>::count; ++lane) {
        const auto found = results_of_lane(scene, PackedThrows<T>(throws, i + n - lane), lane);
        CHECK(std::memcmp(&found, &expected, sizeof found) == 0);
      }
    };
    check(Pack<1>());
    check(Pack<2>());
  }
}

TEST_CASE("Without a flight every result is NaN") {
  for (const double diameter : {0.0, 1.0}) {
    Scene scene = scene_with_drag(0.01);
    scene.projectile_diameter = diameter;
    for (const double value : values(flight<double>(scene, {0, -4.1}, {10, 10})))
      CHECK(std::isnan(value));
    const auto r = range_and_slope<double>(scene, {0, -4.1}, {10, 10}, {1, 1}, 1e-9);
    CHECK(std::isnan(r.value));
    CHECK(std::isnan(r.slope));
    const auto ok = flight<double>(scene, {1, -4}, {10, -10});
    CHECK(values(ok) == std::vector<double>{1, 0, std::hypot(10, 10), 0});
  }
}

TEST_CASE(
    "A feather reaches its terminal velocity; if that takes too many steps, it does not land") {
  Scene scene = scene_with_drag(9.8 / (0.1 * 0.1));  // a terminal velocity of 0.1 m/s
  const auto f = flight<double>(scene, {0, 0}, {30, 30});
  CHECK(f.impact_speed == Approx(0.1).epsilon(1e-9));
  CHECK(f.time == Approx(fulcrum_height / 0.1).epsilon(0.01));
  scene.fulcrum_height = 1e4;
  const auto endless = flight<double>(scene, {0, 0}, {30, 30});
  CHECK(endless.apex == Approx(scene.fulcrum_height + f.apex - fulcrum_height));
  for (const double value : {endless.range, endless.time, endless.impact_speed})
    CHECK(std::isnan(value));
  CHECK(std::isnan(range_and_slope<double>(scene, {0, 0}, {30, 30}, {1, 0}, 1e-9).slope));
}

#if __has_include(<gsl/gsl_odeiv2.h>)
namespace {

int gsl_rates(double, const double s[], double rates[], void* parameter) {
  const Scene& scene = *static_cast<Scene*>(parameter);
  const double ux = s[2] - scene.wind, uy = s[3];
  const double damping = drag_constant(scene) * std::hypot(ux, uy);
  rates[0] = s[2];
  rates[1] = s[3];
  rates[2] = -damping * ux;
  rates[3] = -damping * uy - scene.gravity;
  return GSL_SUCCESS;
}

/// The flight by GSL, without its apex.
Flight<double> gsl_flight(Scene scene, const Throw& t) {
  gsl_odeiv2_system system{gsl_rates, nullptr, 4, &scene};
  gsl_odeiv2_driver* driver =
      gsl_odeiv2_driver_alloc_y_new(&system, gsl_odeiv2_step_rk8pd, 1e-3, 1e-13, 1e-13);
  std::array<double, 4> s{t.position.x, t.position.y + fulcrum_height, t.velocity.x, t.velocity.y};
  double time = 0;
  // To a time when the projectile falls to the ground soon, and then by Newton's method.
  for (double h = 0.1; s[1] > 0 || s[3] > 0;)
    gsl_odeiv2_driver_apply(driver, &time, time + h, s.data());
  for (int i = 0; i < 10 && std::abs(s[1]) > 1e-13; ++i) {
    const double to = time - s[1] / s[3];
    gsl_odeiv2_driver_reset_hstart(driver, to > time ? 1e-3 : -1e-3);
    gsl_odeiv2_driver_apply(driver, &time, to, s.data());
  }
  gsl_odeiv2_driver_free(driver);
  return {s[0], time, std::hypot(s[2], s[3]), 0};
}

}  // namespace

TEST_CASE("Flights with wind agree with GSL's") {
  const Scene scene = scene_with_drag(0.004, -8);
  for (const Throw& t : random_throws(20)) {
    const auto found = flight(scene, t.position, t.velocity), expected = gsl_flight(scene, t);
    CHECK(std::abs(found.range - expected.range) < 1e-9);
    CHECK(std::abs(found.time - expected.time) < 1e-9);
    CHECK(std::abs(found.impact_speed - expected.impact_speed) < 1e-9);
  }
}
#endif
