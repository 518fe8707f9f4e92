#include "trebsweep/record.hpp"

#include <vector>

#include "catch.hpp"
#include "trebsweep/integrate.hpp"
#include "trebsweep/sample.hpp"
#include "trebsweep/swing.hpp"

using namespace trebsweep;

namespace {

constexpr Design<double> optimum{0.51, 0.58, 0.91};

Solver accurate(double tolerance) {
  Solver solver;
  solver.stepper = "fehlberg78";
  solver.tolerance = tolerance;
  solver.release = Release::crossing;
  return solver;
}

/// The values of some fields, and the outcome's speed last; by fehlberg78.
std::vector<double> shoot(const Scene& scene, const std::vector<Field>& fields,
                          double tolerance = 1e-10) {
  std::vector<double> values(fields.size());
  const double speed = with_effects(scene, [&]<Effects E>() {
    return swing<Fehlberg78<double, E>, double, E>(scene, optimum, accurate(tolerance), {}, fields,
                                                   values)
        .speed;
  });
  values.push_back(speed);
  return values;
}

}  // namespace

TEST_CASE("A peak between equal or unequal samples is the parabola's through them") {
  const auto f = [](double x) { return 3 - (x - 0.4) * (x - 0.4); };
  for (const double part : {0.3, 0.5, 0.6})
    CHECK(larger_peak(0.0, f(0), f(part), f(1), part) == Approx(3));
  CHECK(larger_peak(0.0, 1.0, 2.0, 3.0, 0.5) == 3);    // a line has its peak at an end
  CHECK(larger_peak(0.0, 2.0, 1.0, 2.5, 0.5) == 2.5);  // a valley too
  CHECK(larger_peak(9.0, 1.0, 2.0, 1.0, 0.5) == 9);
}

TEST_CASE("Peaks are those of a fine trace of the swing") {
  const std::vector<Field> fields{Field::least_sling_tension, Field::peak_sling_tension,
                                  Field::peak_axle_load, Field::peak_beam_stress};
  const Mechanism<double> mechanism(Scene{}, optimum);
  Record<double> fine;
  Solver solver = accurate(1e-10);
  solver.stepper = "rk4";
  solver.time_step = 1e-4;
  swing<RungeKutta4<double>, double>(Scene{}, optimum, solver, [&](const auto&, const auto& to) {
    const auto loads = mechanism.loads(to.x, to.dxdt);
    fine.least_pull = std::min(fine.least_pull, loads.projectile_pull);
    fine.peak_pull = std::max(fine.peak_pull, loads.tip_pull);
    fine.peak_axle = std::max(fine.peak_axle, loads.axle);
    fine.peak_stress = std::max(fine.peak_stress, loads.beam_stress);
  });
  const auto values = shoot(Scene{}, fields, 1e-9);
  CHECK(values[0] == Approx(fine.least_pull).epsilon(1e-4));
  CHECK(values[1] == Approx(fine.peak_pull).epsilon(1e-4));
  CHECK(values[2] == Approx(fine.peak_axle).epsilon(1e-4));
  CHECK(values[3] == Approx(fine.peak_stress).epsilon(1e-4));
}

TEST_CASE("Energy is balanced to the tolerance with every combination of effects") {
  for (const double stiffness : {0.0, 1e5})
    for (const double friction : {0.0, 500.0})
      for (const double mass : {0.0, 5.0}) {
        Scene scene;
        scene.sling_stiffness = stiffness;
        scene.sling_damping = stiffness > 0 ? 300 : 0;
        scene.pivot_friction = friction;
        scene.pivot_viscosity = friction / 10;
        scene.sling_mass = mass;
        INFO(stiffness << " " << friction << " " << mass);
        CHECK(std::abs(shoot(scene, {Field::energy_drift}, 1e-10)[0]) < 1e-8);
      }
}

TEST_CASE("A stiff sling falls short of a rigid one by the energy left in its stretch") {
  // That is S^2/2k for the pull S at the release: m3 v dv, of the projectile's energy.
  const double rigid = shoot(Scene{}, {})[0];
  const double pull = shoot(Scene{}, {Field::peak_sling_tension})[0];  // largest at the release
  for (const double stiffness : {1e5, 1e6, 1e7}) {
    Scene scene;
    scene.sling_stiffness = stiffness;
    const double expected = pull * pull / (2 * stiffness * scene.projectile_mass * rigid);
    const double short_fall = rigid - shoot(scene, {})[0];
    INFO(stiffness << " " << short_fall << " " << expected);
    CHECK(short_fall / expected == Approx(1).margin(stiffness < 1e6 ? 0.15 : 0.06));
  }
}

TEST_CASE("Values at the release follow from the state there") {
  const auto v = shoot(Scene{}, {Field::sling_angle, Field::arm_rate, Field::sling_rate,
                                 Field::kinetic_energy, Field::efficiency, Field::range});
  const double speed = v.back(), g = 9.8;
  CHECK(v[3] == Approx(50 * speed * speed));
  // The arm is upright: the projectile's velocity and place from the angles.
  const double vx = 0.91 * v[1] - 0.58 * v[2] * std::cos(v[0]);
  const double vy = 0.58 * v[2] * std::sin(v[0]);
  CHECK(std::hypot(vx, vy) == Approx(speed));
  const double height = 1.5 + 0.91 - 0.58 * std::cos(v[0]);
  CHECK(v[5] == Approx(vx * (vy + std::sqrt(vy * vy + 2 * g * height)) / g));
  // Weights' heights: counterweight and beam fall, the projectile rises.
  const double m2 = 7850 * 0.01 * 1.42,
               turn = 0.5 / 0.51 + 1;  // cos phi1 falls from 0.5/0.51 to -1
  const double given =
      g * ((5000 * 0.51 - m2 * 0.2 - 100 * 0.91) * turn - 100 * 0.58 * (1 - std::cos(v[0])));
  CHECK(v[4] == Approx(v[3] / given));
}

TEST_CASE(
    "A range is positive where the projectile flies as the arm's tip does, negative backwards") {
  const Scene scene;
  const auto designs = sample(Lattice(scene, LatticeSpec()), 400);
  const std::vector<Field> fields{Field::sling_angle, Field::arm_rate, Field::sling_rate,
                                  Field::range};
  std::vector<Shot> shots(designs.size());
  std::vector<double> values(designs.size() * fields.size());
  integrate(scene, accurate(1e-9), designs, fields, shots, values);
  int forwards = 0, backwards = 0;
  for (std::size_t n = 0; n < designs.size(); ++n) {
    if (shots[n].status != Status::released) continue;
    const auto [r1, r3, r2] = designs[n];
    const double angle = values[4 * n], w = values[4 * n + 1], sling_rate = values[4 * n + 2];
    REQUIRE(w > 0);  // at phi1 = pi the arm's tip moves along +x
    const double vx = r2 * w - r3 * sling_rate * std::cos(angle);
    const double vy = r3 * sling_rate * std::sin(angle);
    const double height = scene.fulcrum_height + r2 - r3 * std::cos(angle), g = scene.gravity;
    const double range = vx * (vy + std::sqrt(vy * vy + 2 * g * height)) / g;
    CHECK(values[4 * n + 3] == Approx(range).epsilon(1e-9).margin(1e-9));
    ++(vx < 0 ? backwards : forwards);
  }
  CHECK(forwards > 0);
  CHECK(backwards > 0);
}

TEST_CASE("A sling that pulls throughout is taut, one that would push is slack") {
  CHECK(shoot(Scene{}, {Field::slack})[0] == 1);
  Scene scene;
  scene.sling_angle = 2.5;  // held up beside the beam: falls freely at first
  const auto values = shoot(scene, {Field::slack, Field::least_sling_tension});
  CHECK(values[0] == 2);
  CHECK(values[1] < 0);
}

TEST_CASE("A beam that dry friction holds is never released") {
  Scene scene;
  scene.pivot_friction = 1e6;
  const auto outcome =
      swing<Fehlberg78<double, Effects{true, false}>, double, Effects{true, false}>(scene, optimum,
                                                                                    accurate(1e-9));
  CHECK(outcome.status == Status::not_released);
  CHECK(outcome.x[w1] == 0);
  CHECK(outcome.x[phi1] == start<double>(scene, optimum)[phi1]);
}

TEST_CASE("Friction stops an arm that swings back and forth, at rest in the end") {
  Scene scene;
  scene.projectile_mass = 3600;  // too heavy: the arm turns back before pi
  scene.pivot_friction = 3000;
  scene.pivot_viscosity = 20000;
  Solver solver = accurate(1e-8);
  solver.max_time = 60;
  constexpr Effects E{true, false};
  const auto outcome = swing<Dopri5<double, E>, double, E>(scene, optimum, solver);
  CHECK(outcome.status == Status::not_released);
  CHECK(std::abs(outcome.x[w1]) < 1e-6);
}

TEST_CASE("A release below the ground has a status of its own, and no range") {
  std::vector<double> values(1);
  const std::vector<Field> fields{Field::range};
  Scene scene;
  scene.fulcrum_height = 0.1;
  scene.release_height = 0.5;
  const Design<double> deep{0.51, 3, 0.4};
  const auto shot =
      swing<Fehlberg78<double>, double>(scene, deep, accurate(1e-9), {}, fields, values);
  REQUIRE(scene.fulcrum_height + Mechanism<double>(scene, deep).projectile(shot.x).y < 0);
  CHECK(shot.status == Status::released_below_ground);
  CHECK(std::isnan(values[0]));
  CHECK(shot.speed > 0);
}
