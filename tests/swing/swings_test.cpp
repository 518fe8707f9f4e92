#include "trebsweep/swing/swings.hpp"

#include <boost/math/special_functions/ellint_1.hpp>
#include <fstream>
#include <sstream>

#include "support/catch.hpp"
#include "support/machines.hpp"
#include "support/paper_solver.hpp"
#include "trebsweep/model/start.hpp"
#include "trebsweep/ode/stepper.hpp"
#include "trebsweep/swing/integrate.hpp"
#include "trebsweep/swing/reference.hpp"
#include "trebsweep/swing/swing.hpp"

using namespace trebsweep;

namespace {

constexpr double pi = boost::math::double_constants::pi;

Outcome<double, general_effects[0]> swing_of(const Scene& scene, const Design<double>& design,
                                             const Solver& solver) {
  return swing<general_effects[0]>(scene, design, solver);
}

Solver accurate(double tolerance, const std::string& stepper = "dopri5") {
  Solver solver;
  solver.stepper = stepper;
  solver.release = Release::crossing;
  solver.tolerance = tolerance;
  return solver;
}

const Solver tight = accurate(1e-13, "fehlberg78");

}  // namespace

TEST_CASE("The paper's optimum: 17.47606519 m/s at step 92 by the paper's rules") {
  const auto result = swing_of(Scene{}, paper_optimum, paper_solver());
  REQUIRE(result.status == Status::released);
  CHECK(result.speed == Approx(17.47606519).margin(5e-9));
  CHECK(result.steps == 92);
  CHECK(result.t == 0.92);
}

TEST_CASE("Every adaptive stepper finds the true speed of the paper's optimum") {
  for (const std::string name : {"cash_karp54", "dopri5", "fehlberg78", "vern7", "vern8"}) {
    const auto result = swing_of(Scene{}, paper_optimum, accurate(1e-13, name));
    CHECK(result.t == Approx(0.907088591346).margin(1e-12));
    CHECK(result.speed == Approx(16.8555869074).margin(1e-10));
    CHECK(result.x[phi1] == Approx(pi).epsilon(1e-15));
    CHECK(result.x[phi2] == Approx(2.82549).margin(5e-6));
    CHECK(result.x[w1] == Approx(6.9509).margin(5e-5));
  }
}

TEST_CASE("The fields of a result are values like the others, in any order and also repeated") {
  const Scene scene;
  const std::array designs{paper_optimum, Design<double>{0.6, 0.5, 0.8},
                           Design<double>{1, 0.1, 0.3}};
  std::vector<SwingResult> results(3);
  const auto values_of = [&](const std::vector<Field>& fields) {
    std::vector<double> values(3 * fields.size());
    integrate(scene, accurate(1e-9), {designs, results, fields, values});
    return values;
  };
  const auto ranges = values_of({Field::range});
  const auto values = values_of({Field::status, Field::range, Field::speed, Field::range,
                                 Field::release_time, Field::steps, Field::speed_error});
  const auto speeds = values_of({Field::speed});
  for (std::size_t n = 0; n < 3; ++n) {
    const auto& [speed, time, steps, status] = results[n];
    REQUIRE(speed > 0);
    CHECK(std::abs(values[7 * n + 6]) < 1e-6);
    const std::vector<double> expected{
        static_cast<double>(status), ranges[n], speed, ranges[n], time, static_cast<double>(steps)};
    CHECK(std::vector(&values[7 * n], &values[7 * n + 6]) == expected);
    CHECK(speeds[n] == speed);
  }
}

TEST_CASE("Three designs have the results on which three other programs agree") {
  Scene scene;
  scene.gravity = 9.81;
  struct Known {
    Design<double> design;
    double time, speed, degrees;
  };
  for (const Known& known : {Known{{1, 3, 4}, 1.0009885268, 22.5466224886, 89.517465},
                             Known{{1, 5, 6}, 1.5071707683, 19.4996201747, 78.980320},
                             Known{{0.75, 3, 4}, 1.1364650403, 23.7371408230, 101.815151}}) {
    const auto result = swing_of(scene, known.design, tight);
    CHECK(result.t == Approx(known.time).margin(6e-11));
    CHECK(result.speed == Approx(known.speed).margin(6e-11));
    CHECK(result.x[phi2] * 180 / pi == Approx(known.degrees).margin(6e-7));
  }
}

TEST_CASE("Unusual scenes have their known outcomes") {
  const auto short_sling = swing_of(Scene{}, {0.51, 0.001, 0.91}, tight);
  CHECK(short_sling.t == Approx(0.899289578).margin(6e-10));
  CHECK(short_sling.speed == Approx(7.44223).margin(6e-6));

  Scene heavy;
  heavy.projectile_mass = 2600;
  CHECK(swing_of(heavy, paper_optimum, tight).t == Approx(5.55722854).margin(6e-9));
  CHECK(swing_of(heavy, paper_optimum, tight).speed == Approx(1.29989704).margin(6e-9));
  heavy.projectile_mass = 2700;
  CHECK(swing_of(heavy, paper_optimum, tight).t == Approx(8.43435952).margin(6e-9));
  heavy.projectile_mass = 5000;
  CHECK(swing_of(heavy, paper_optimum, tight).status == Status::not_released);
  Scene light;
  light.counterweight_mass = 100;
  CHECK(swing_of(light, paper_optimum, tight).status == Status::not_released);
}

TEST_CASE(
    "The legible rows of the paper's Appendix C, without the beam's inertia, are reproduced") {
  Scene scene;
  scene.beam_inertia = BeamInertia::none;
  std::vector<State<double>> states{start(scene, paper_optimum)};
  const auto record = [&](const Instant<double, general_effects[0]>&,
                          const Instant<double, general_effects[0]>& to) {
    states.push_back(to.x);
  };
  const auto outcome = swing<general_effects[0]>(scene, paper_optimum, paper_solver(), record);
  CHECK(outcome.steps == 91);

  std::ifstream file(SOURCE_DIR "/tests/swing/appendix_c.csv");
  std::string line;
  std::getline(file, line);
  int rows = 0;
  for (double t, angle1, angle2; std::getline(file, line); ++rows) {
    char comma;
    std::istringstream(line) >> t >> comma >> angle1 >> comma >> angle2;
    const State<double>& x = states.at(static_cast<std::size_t>(std::lround(t / 0.01)));
    CHECK(std::abs(x[phi1] - angle1) < 6e-6);
    CHECK(std::abs(x[phi2] - angle2) < 6e-6);
  }
  CHECK(rows == 65);
}

TEST_CASE("With a massless projectile the beam is a physical pendulum") {
  Scene scene;
  scene.projectile_mass = 1e-12;
  for (const Design<double>& d : {paper_optimum, Design<double>{1.2, 0.5, 0.4}}) {
    const double m2 = scene.beam_density * scene.beam_side * scene.beam_side * (d.r1 + d.r2);
    const double m1 = scene.counterweight_mass, r = (d.r2 - d.r1) / 2;
    const double G = scene.gravity * (m1 * d.r1 - m2 * r);
    const double I = m1 * d.r1 * d.r1 + m2 * std::pow(d.r1 + d.r2, 2) / 12 + m2 * r * r;
    const double start = std::acos(0.5 / d.r1);
    const double k = std::sin((pi - start) / 2);
    const auto result = swing_of(scene, d, tight);
    CHECK(result.t == Approx(boost::math::ellint_1(k) / std::sqrt(G / I)).epsilon(1e-12));
    CHECK(result.x[w1] == Approx(std::sqrt(2 * G * (1 + std::cos(start)) / I)).epsilon(1e-12));
  }
}

TEST_CASE("Balanced torques never turn the beam") {
  Scene scene;
  scene.beam_density = 0;
  scene.projectile_mass = scene.counterweight_mass;
  for (const Solver& solver : {paper_solver(), tight}) {
    const auto result = swing_of(scene, {1, 0.5, 1}, solver);
    CHECK(result.status == Status::not_released);
    CHECK(result.t == 10);
    CHECK(result.x == start<double>(scene, {1, 0.5, 1}));
  }
}

TEST_CASE("A vanishing throwing arm leaves the sling at rest") {
  const auto result = swing_of(Scene{}, {0.51, 0.58, 1e-9}, tight);
  CHECK(result.status == Status::released);
  CHECK(result.speed < 1e-7);
}

TEST_CASE("Energy stays constant to the tolerance over a long swing") {
  Scene scene;
  scene.projectile_mass = 2700;  // 8.4 s to its release
  for (const double tolerance : {1e-6, 1e-9, 1e-12}) {
    const Mechanism<double, general_effects[0]> mechanism(scene, paper_optimum);
    const double before = mechanism.energy(start(scene, paper_optimum));
    double drift = 0, kinetic = 0;
    const auto observe = [&](const Instant<double, general_effects[0]>&,
                             const Instant<double, general_effects[0]>& to) {
      drift = std::max(drift, std::abs(mechanism.energy(to.x) - before));
      kinetic = std::max(kinetic, mechanism.kinetic_energy(to.x));
    };
    swing<general_effects[0]>(scene, paper_optimum, accurate(tolerance), observe);
    CHECK(drift < 1000 * tolerance * kinetic);
    CHECK(drift > 0);
  }
}

TEST_CASE("A swing in double precision agrees with extended precision") {
  const Reference truth = reference(Scene{}, paper_optimum, tight);
  const auto result = swing_of(Scene{}, paper_optimum, tight);
  CHECK(result.t == Approx(static_cast<double>(truth.release_time)).epsilon(1e-13));
  CHECK(result.speed == Approx(truth.speed).epsilon(1e-12));
}

TEST_CASE("The located release converges with order 1 for euler and 4 for rk4") {
  const double truth = swing_of(Scene{}, paper_optimum, tight).speed;
  const auto error = [&](const std::string& stepper, double step) {
    Solver solver = accurate(1e-9, stepper);
    solver.time_step = step;
    const auto result = swing_of(Scene{}, paper_optimum, solver);
    CHECK(std::abs(result.x[phi1] - pi) < 1e-14);
    return std::abs(result.speed - truth);
  };
  CHECK(std::log2(error("euler", 2e-4) / error("euler", 1e-4)) == Approx(1).margin(0.05));
  CHECK(std::log2(error("rk4", 4e-3) / error("rk4", 2e-3)) == Approx(4).margin(0.2));
}

TEST_CASE("The error of a release follows the tolerance") {
  const double truth = swing_of(Scene{}, paper_optimum, tight).speed;
  for (const std::string name : {"cash_karp54", "dopri5", "fehlberg78", "vern7", "vern8"})
    for (const double tolerance : {1e-5, 1e-7, 1e-9, 1e-11})
      CHECK(std::abs(swing_of(Scene{}, paper_optimum, accurate(tolerance, name)).speed - truth) <
            100 * tolerance);
}

TEST_CASE("A time limit ends a swing as not_released, at the limit") {
  Solver solver = accurate(1e-9);
  solver.max_time = 0.5;
  const auto result = swing_of(Scene{}, paper_optimum, solver);
  CHECK(result.status == Status::not_released);
  CHECK(result.t == 0.5);
}

TEST_CASE("A step budget ends a swing as step_budget") {
  for (const std::string name : {"euler", "dopri5"}) {
    Solver solver = accurate(1e-9, name);
    solver.max_steps = 7;
    const auto result = swing_of(Scene{}, paper_optimum, solver);
    CHECK(result.status == Status::step_budget);
    CHECK(result.steps == 7);
  }
}

TEST_CASE("A window narrower than a step may be stepped over") {
  Solver solver = paper_solver();
  solver.release_window = 1e-6;
  CHECK(swing_of(Scene{}, paper_optimum, solver).status == Status::not_released);
}

TEST_CASE("A state that overflows has status non_finite and no speed") {
  Scene scene;
  scene.gravity = 1e306;
  for (const auto name : stepper_names) {
    const auto result = swing_of(scene, paper_optimum, accurate(1e-9, std::string(name)));
    CHECK(result.status == Status::non_finite);
  }
  Solver euler = accurate(1e-9, "euler");
  euler.time_step = 1e160;
  euler.max_time = 1e170;
  CHECK(swing_of(Scene{}, paper_optimum, euler).status == Status::non_finite);
}

TEST_CASE("Steps too short to change the time end a swing as step_underflow") {
  const Design<double> tiny_sling{0.51, 1e-34, 0.91};  // its swing would take 1e-17 s
  for (const std::string name : {"cash_karp54", "dopri5", "fehlberg78", "vern7", "vern8"})
    CHECK(swing_of(Scene{}, tiny_sling, accurate(1e-9, name)).status == Status::step_underflow);
}

TEST_CASE("A distant time limit changes nothing") {
  Solver solver = accurate(1e-9);
  const auto result = swing_of(Scene{}, paper_optimum, solver);
  solver.max_time = 1e300;
  CHECK(swing_of(Scene{}, paper_optimum, solver).speed == result.speed);
}

TEST_CASE("A release after the time limit does not count, even within a fixed step") {
  for (const std::string name : {"euler", "rk4", "dopri5"}) {
    Solver solver = accurate(1e-9, name);
    solver.time_step = 0.3;
    const double time = swing_of(Scene{}, paper_optimum, solver).t;
    solver.max_time = time - 1e-3;
    CHECK(swing_of(Scene{}, paper_optimum, solver).status == Status::not_released);
    solver.max_time = time + 1e-3;
    CHECK(swing_of(Scene{}, paper_optimum, solver).status == Status::released);
  }
}

TEST_CASE("A counterweight that starts at its lowest point is not released at the start") {
  Scene scene;
  scene.release_height = 0.5;
  for (const Release release : {Release::crossing, Release::window}) {
    Solver solver = accurate(1e-9, "euler");
    solver.release = release;
    solver.max_time = 0.5;
    const auto result = swing_of(scene, {1, 0.58, 0.91}, solver);
    CHECK(result.t > 0);
    CHECK(result.speed < 1e-12);
  }
}
