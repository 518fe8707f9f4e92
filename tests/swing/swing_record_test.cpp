#include "trebsweep/swing/swing_record.hpp"

#include <algorithm>
#include <cstring>
#include <span>
#include <vector>

#include "support/catch.hpp"
#include "support/machines.hpp"
#include "trebsweep/job/sample.hpp"
#include "trebsweep/model/start.hpp"
#include "trebsweep/swing/advance.hpp"
#include "trebsweep/swing/integrate.hpp"
#include "trebsweep/swing/swing.hpp"

using namespace trebsweep;

namespace {

Solver by_fehlberg78(double tolerance) {
  Solver solver;
  solver.stepper = "fehlberg78";
  solver.tolerance = tolerance;
  solver.release = Release::crossing;
  return solver;
}

/// The values of some fields, and the outcome's speed last; by fehlberg78.
std::vector<double> values_of(const Scene& scene, const std::vector<Field>& fields,
                              double tolerance = 1e-10) {
  std::vector<double> values(fields.size());
  const double speed = with_general_effects(scene, [&]<Effects E>() {
    return swing<E>(scene, paper_optimum, by_fehlberg78(tolerance), {}, fields, values).speed;
  });
  values.push_back(speed);
  return values;
}

}  // namespace

TEST_CASE("A peak is the maximum of the interpolating polynomial, or the largest sample") {
  constexpr std::array<double, 4> nodes{0, 0.3, 0.6, 1};
  const auto found = [&](auto f) {
    std::array<double, 4> values;
    std::transform(nodes.begin(), nodes.end(), values.begin(), f);
    return peak(nodes, values);
  };
  const auto peak_of = [&](auto f) { return found(f).value; };
  CHECK(peak_of([](double x) { return 3 - (x - 0.4) * (x - 0.4); }) == Approx(3));
  CHECK(peak_of([](double x) { return x * (1 - x * x); }) == Approx(2 / std::sqrt(27)));
  CHECK(peak_of([](double x) { return -4 * std::pow(x - 0.05, 2); }) == Approx(0).margin(1e-15));
  CHECK(peak_of([](double x) { return 1 + x; }) == 2);                     // at the end
  CHECK(peak_of([](double x) { return (x - 0.5) * (x - 0.5); }) == 0.25);  // a valley
  CHECK(peak_of([](double) { return 5; }) == 5);
  CHECK(found([](double x) { return 3 - (x - 0.4) * (x - 0.4); }).at == Approx(0.4));
  CHECK(found([](double x) { return x * (1 - x * x); }).at == Approx(1 / std::sqrt(3)));
  CHECK(found([](double x) { return 1 + x; }).at == 1);
  CHECK(found([](double x) { return (x - 0.5) * (x - 0.5); }).at == 0);
}

TEST_CASE("A motion of degree five is interpolated exactly, also over a step of zero length") {
  // phi1 = t^5, phi2 = 1 - t + t^4
  const auto at = [](double t) {
    Instant<double> now{};
    now.x = {std::pow(t, 5), 1 - t + std::pow(t, 4), 5 * std::pow(t, 4), 4 * t * t * t - 1};
    now.dxdt = {now.x[w1], now.x[w2], 20 * t * t * t, 12 * t * t};
    return now;
  };
  const Quintic<double, Effects{}> between(at(0.5), at(2.0), 1.5);
  for (const double part : {0.0, 0.3, 0.5, 0.9, 1.0})
    for (std::size_t i = 0; i < 4; ++i)
      CHECK(between(part)[i] == Approx(at(0.5 + 1.5 * part).x[i]).epsilon(1e-13));
  const Quintic<double, Effects{}> none(at(0.5), at(0.5), 0);
  CHECK(none(0.3) == at(0.5).x);
}

namespace {

/// Peaks of the parabolas through consecutive samples.
struct FinePeaks {
  std::array<double, 4> largest{-1e300, 0, 0, 0};  // the first is negated
  std::array<double, 4> before{}, last{};
  int count = 0;

  /// Starts a sequence that does not continue the last one smoothly.
  void begin() { count = 0; }

  void add(const Loads<double>& loads) {
    const std::array<double, 4> next{-loads.projectile_tension, loads.tip_tension, loads.axle,
                                     std::abs(loads.beam_stress)};
    for (std::size_t i = 0; i < 4; ++i) {
      largest[i] = std::max(largest[i], next[i]);
      const double rise = (next[i] - before[i]) / 2, bend = next[i] + before[i] - 2 * last[i];
      if (count > 1 && last[i] > before[i] && last[i] > next[i])
        largest[i] = std::max(largest[i], last[i] - rise * rise / (2 * bend));
    }
    before = std::exchange(last, next);
    ++count;
  }
};

struct Swung {
  Status status;
  double speed;
  std::array<double, 4> recorded, fine;
};

/// Recorded peaks, and those of a fine sequence: the stepper integrates from the start of each step
/// to instants every half millisecond.
template <Effects E>
Swung swing_finely(const Scene& scene, const Design<double>& design, const Solver& solver) {
  constexpr std::array fields{Field::least_sling_tension, Field::peak_sling_tension,
                              Field::peak_axle_load, Field::peak_beam_stress};
  const Mechanism<double, E> mechanism(scene, design);
  const Motion<double, E> motion(scene, design);
  const auto advance = make_advance<E>(scene, design, solver);
  FinePeaks fine;
  Swung swung{};
  const auto sample_finely = [&](const Instant<double, E>& from, const Instant<double, E>& to) {
    const int parts = std::max(6, static_cast<int>((to.t - from.t) / 5e-4));
    fine.begin();
    fine.add(loads_at(motion, mechanism, from));
    for (int i = 1; i < parts; ++i) {
      const auto at = advance(motion, from, (to.t - from.t) * i / parts);
      fine.add(loads_at(motion, mechanism, at));
    }
    fine.add(loads_at(motion, mechanism, to));
  };
  const auto outcome = swing<E>(scene, design, solver, sample_finely, fields, swung.recorded);
  swung.status = outcome.status;
  swung.speed = outcome.speed;
  swung.fine = fine.largest;
  swung.fine[0] = E.elastic ? std::max(0.0, -fine.largest[0]) : -fine.largest[0];
  return swung;
}

}  // namespace

TEST_CASE("Recorded peaks of every stepper equal those of a fine sampling of its swing", "[slow]") {
  Scene friction, elastic;
  friction.pivot_friction = 510;
  friction.pivot_viscosity = 20;
  elastic.sling_mass = 1;
  elastic.sling_stiffness = 3e5;
  elastic.sling_damping = 500;
  int swings = 0;
  for (const Scene& scene : {Scene{}, friction, elastic})
    with_general_effects(scene, [&]<Effects E>() {
      auto designs = sample(Lattice(scene, LatticeSpec()), 6);
      designs.push_back(paper_optimum);
      const double weight = scene.projectile_mass * scene.gravity;
      for (const Design<double>& design : designs)
        for (const auto name : stepper_names) {
          const bool adaptive = follows_tolerance(name);
          for (const double accuracy : adaptive ? std::array{1e-4, 1e-6, 1e-8, 1e-10, 1e-12}
                                                : std::array{1e-2, 3e-3, 1e-3, 3e-4, 1e-4}) {
            Solver solver = by_fehlberg78(accuracy);
            solver.stepper = name;
            solver.time_step = accuracy;
            solver.max_time = 3;
            const Swung swung = swing_finely<E>(scene, design, solver);
            if (!has_speed(swung.status)) continue;
            // Long steps of an elastic sling are unstable: energy permits no more than 50 m/s.
            if (swung.speed > 100) continue;
            ++swings;
            double allowed = adaptive && accuracy > 1e-5 ? 2e-3 : 1e-5;
            if (E.elastic) {
              allowed = std::max(allowed, 2e-5);
              // The stiffness turns an error of the sling's length into a force.
              if (adaptive) allowed += 3 * scene.sling_stiffness * accuracy / weight;
            }
            for (std::size_t i = 0; i < 4; ++i) {
              // The least tension may be zero.
              const double size = std::max(std::abs(swung.fine[i]), i == 0 ? weight : 0);
              INFO(name << " at " << accuracy << ", load " << i << " of the design " << design.r1
                        << " " << design.r3 << " " << design.r2);
              CHECK(std::abs(swung.recorded[i] - swung.fine[i]) <= allowed * size);
            }
          }
        }
    });
  CHECK(swings > 1500);
}

TEST_CASE("Loads of a design are bitwise independent of the rest of the batch") {
  const std::vector<Field> fields{Field::least_sling_tension, Field::peak_sling_tension,
                                  Field::peak_axle_load, Field::peak_beam_stress};
  Scene elastic;
  elastic.sling_stiffness = 3e5;
  const auto designs = sample(Lattice(Scene{}, LatticeSpec()), 40);
  const auto loads = [&](const Scene& scene, const Solver& solver,
                         std::span<const Design<double>> some) {
    std::vector<SwingResult> results(some.size());
    std::vector<double> values(some.size() * fields.size());
    integrate(scene, solver, {some, results, fields, values});
    return values;
  };
  for (const Scene& scene : {Scene{}, elastic})
    for (const double tolerance : {1e-6, 1e-9}) {  // steps in two parts, and whole
      const Solver solver = by_fehlberg78(tolerance);
      const auto together = loads(scene, solver, designs);
      for (std::size_t n = 0; n < designs.size(); ++n) {
        const auto alone = loads(scene, solver, std::span(designs).subspan(n, 1));
        CHECK(std::memcmp(alone.data(), &together[n * fields.size()],
                          alone.size() * sizeof(double)) == 0);
      }
    }
}

TEST_CASE("Energy and losses balance to the tolerance for every combination of effects") {
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
        CHECK(std::abs(values_of(scene, {Field::energy_drift}, 1e-10)[0]) < 1e-8);
      }
}

TEST_CASE("A stiff sling loses the speed that corresponds to its elastic energy at the release") {
  // The elastic energy S^2/2k for the tension S at the release equals m3 v dv.
  const double rigid = values_of(Scene{}, {})[0];
  const double tension =
      values_of(Scene{}, {Field::peak_sling_tension})[0];  // largest at the release
  for (const double stiffness : {1e5, 1e6, 1e7}) {
    Scene scene;
    scene.sling_stiffness = stiffness;
    const double expected = tension * tension / (2 * stiffness * scene.projectile_mass * rigid);
    const double shortfall = rigid - values_of(scene, {})[0];
    INFO(stiffness << " " << shortfall << " " << expected);
    CHECK(shortfall / expected == Approx(1).margin(stiffness < 1e6 ? 0.15 : 0.06));
  }
}

TEST_CASE("Fields at the release follow from the state") {
  const auto v = values_of(Scene{}, {Field::sling_angle, Field::arm_rate, Field::sling_rate,
                                     Field::kinetic_energy, Field::efficiency, Field::range});
  const double speed = v.back(), g = 9.8;
  CHECK(v[3] == Approx(50 * speed * speed));
  // The arm is upright: velocity and position of the projectile from the angles.
  const double vx = 0.91 * v[1] - 0.58 * v[2] * std::cos(v[0]);
  const double vy = 0.58 * v[2] * std::sin(v[0]);
  CHECK(std::hypot(vx, vy) == Approx(speed));
  const double height = 1.5 + 0.91 - 0.58 * std::cos(v[0]);
  const double x3 = -0.58 * std::sin(v[0]);  // from the foot of the fulcrum
  CHECK(v[5] == Approx(x3 + vx * (vy + std::sqrt(vy * vy + 2 * g * height)) / g));
  // Potential energy: counterweight and beam fall, the projectile rises.
  const double m2 = 7850 * 0.01 * 1.42,
               turn = 0.5 / 0.51 + 1;  // cos phi1 falls from 0.5/0.51 to -1
  const double given =
      g * ((5000 * 0.51 - m2 * 0.2 - 100 * 0.91) * turn - 100 * 0.58 * (1 - std::cos(v[0])));
  CHECK(v[4] == Approx(v[3] / given));
}

TEST_CASE(
    "A range is positive in the direction of the arm's tip at the release, negative backwards") {
  const Scene scene;
  const auto designs = sample(Lattice(scene, LatticeSpec()), 400);
  const std::vector<Field> fields{Field::sling_angle, Field::arm_rate, Field::sling_rate,
                                  Field::range};
  std::vector<SwingResult> results(designs.size());
  std::vector<double> values(designs.size() * fields.size());
  integrate(scene, by_fehlberg78(1e-9), {designs, results, fields, values});
  int forwards = 0, backwards = 0;
  for (std::size_t n = 0; n < designs.size(); ++n) {
    if (results[n].status != Status::released) continue;
    const auto [r1, r3, r2] = designs[n];
    const double angle = values[4 * n], w = values[4 * n + 1], sling_rate = values[4 * n + 2];
    REQUIRE(w > 0);  // at phi1 = pi the arm's tip moves along +x
    const double vx = r2 * w - r3 * sling_rate * std::cos(angle);
    const double vy = r3 * sling_rate * std::sin(angle);
    const double height = scene.fulcrum_height + r2 - r3 * std::cos(angle), g = scene.gravity;
    const double x3 = -r3 * std::sin(angle);  // from the foot of the fulcrum
    const double range = x3 + vx * (vy + std::sqrt(vy * vy + 2 * g * height)) / g;
    CHECK(values[4 * n + 3] == Approx(range).epsilon(1e-9).margin(1e-9));
    ++(vx < 0 ? backwards : forwards);
  }
  CHECK(forwards > 0);
  CHECK(backwards > 0);
}

TEST_CASE("A sling under tension throughout is taut; one that would have to push is slack") {
  CHECK(values_of(Scene{}, {Field::slack})[0] == 1);
  Scene scene;
  scene.sling_angle = 2.5;  // nearly upright next to the beam: the projectile falls freely at first
  const auto values = values_of(scene, {Field::slack, Field::least_sling_tension});
  CHECK(values[0] == 2);
  CHECK(values[1] < 0);
}

TEST_CASE("A beam held by dry friction stays at rest and has no release") {
  Scene scene;
  scene.pivot_friction = 1e6;
  const auto outcome = swing<general_effects[0]>(scene, paper_optimum, by_fehlberg78(1e-9));
  CHECK(outcome.status == Status::not_released);
  CHECK(outcome.x[w1] == 0);
  CHECK(outcome.x[phi1] == start<double>(scene, paper_optimum)[phi1]);
}

TEST_CASE("Friction brings an oscillating arm to rest") {
  Scene scene;
  scene.projectile_mass = 3600;  // too heavy: the arm turns back before pi
  scene.pivot_friction = 3000;
  scene.pivot_viscosity = 20000;
  Solver solver = by_fehlberg78(1e-8);
  solver.max_time = 60;
  solver.stepper = "dopri5";
  const auto outcome = swing<general_effects[0]>(scene, paper_optimum, solver);
  CHECK(outcome.status == Status::not_released);
  CHECK(std::abs(outcome.x[w1]) < 1e-6);
}

TEST_CASE("A release below the ground has its own status and no range") {
  std::vector<double> values(1);
  const std::vector<Field> fields{Field::range};
  Scene scene;
  scene.fulcrum_height = 0.1;
  scene.release_height = 0.5;
  const Design<double> deep{0.51, 3, 0.4};
  const auto result =
      swing<general_effects[0]>(scene, deep, by_fehlberg78(1e-9), {}, fields, values);
  REQUIRE(scene.fulcrum_height + Mechanism<double>(scene, deep).projectile(result.x).y < 0);
  CHECK(result.status == Status::released_below_ground);
  CHECK(std::isnan(values[0]));
  CHECK(result.speed > 0);
}
