#include <cmath>
#include <cstring>
#include <vector>

#include "support/catch.hpp"
#include "support/machines.hpp"
#include "trebsweep/model/start.hpp"
#include "trebsweep/swing/advance.hpp"
#include "trebsweep/swing/integrate.hpp"
#include "trebsweep/swing/swing.hpp"

using namespace trebsweep;

namespace {

constexpr std::array releases{Release::crossing, Release::pin, Release::farthest, Release::fastest};

Solver solver_with(Release release, double tolerance = 1e-9) {
  Solver solver;
  solver.tolerance = tolerance;
  solver.release = release;
  solver.pin_angle = 0.6;
  return solver;
}

/// What the steps of a swing show, sampled finely up to the release.
struct Observed {
  double least_tension = INFINITY, peak_tension = 0, peak_axle_load = 0, peak_hanger_tension = 0;
  double loss = 0;      ///< J
  double lift_off = 0;  ///< s
};

template <Effects E>
Observed observe_swing(const Machine& m, const Solver& solver, Outcome<double, E>& outcome) {
  const Mechanism<double, E> mechanism(m.scene, m.design);
  Motion<double, E> motion(m.scene, m.design);
  const auto advance = make_advance<E>(m.scene, m.design, solver);
  Observed o;
  double end = 0;
  outcome = swing<E>(m.scene, m.design, solver, [&](const auto& from, const auto& to) {
    CHECK(from.t <= to.t);
    CHECK(from.t == end);  // no gaps
    end = to.t;
    constexpr int parts = 200;
    const auto power = [&](const auto& at) { return mechanism.dissipation(at.x); };
    auto last = from;
    for (int i = 1; i <= parts && to.t > from.t; ++i) {
      const auto at = advance(motion, from, (to.t - from.t) * i / parts);
      const double normal = motion.normal_force(at.x, at.directions);
      const auto loads = mechanism.loads(at.x, at.directions, at.dxdt, normal);
      o.least_tension = std::min(o.least_tension, loads.projectile_tension);
      o.peak_tension = std::max(o.peak_tension, loads.tip_tension);
      o.peak_axle_load = std::max(o.peak_axle_load, loads.axle);
      o.peak_hanger_tension = std::max(o.peak_hanger_tension, loads.hanger_tension);
      o.loss += (at.t - last.t) * (power(last) + power(at)) / 2;
      last = at;
    }
    if (motion.sliding() > 0 && std::abs(motion.normal_force(to.x, to.directions)) < 1e-3) {
      o.lift_off = to.t;
      motion.set_sliding(0);
    }
  });
  if (has_speed(outcome.status)) CHECK(end == outcome.t);
  return o;
}

}  // namespace

TEST_CASE("Loads and losses are those up to the release by every rule", "[slow]") {
  constexpr std::array fields{Field::least_sling_tension, Field::peak_sling_tension,
                              Field::peak_axle_load,      Field::peak_hanger_tension,
                              Field::lift_off_time,       Field::energy_drift};
  constexpr Effects E{.pivot = true, .hanger = true, .trough = true};
  // The best moment within the swing, and at its end.
  for (const std::string name : {"A", "D"})
    for (const double max_time : {10.0, name == "A" ? 0.56 : 1.36})
      for (const Release release : releases)
        for (const std::string stepper : {"vern8", "dopri5", "rk4"}) {
          Machine m = machine(name);
          m.scene.pivot_viscosity = name == "A" ? 0.5 : 500;
          Solver solver = solver_with(release);
          solver.stepper = stepper;
          solver.time_step = 1e-3;
          solver.max_time = max_time;
          INFO(name << " " << static_cast<int>(release) << " " << stepper << " until " << max_time);
          Outcome<double, E> outcome;
          const Observed o = observe_swing<E>(m, solver, outcome);
          std::array<double, fields.size()> v, alone;
          SwingResult result;
          integrate(m.scene, solver, {{&m.design, 1}, {&result, 1}, fields, v});
          REQUIRE(has_speed(result.status) == has_speed(outcome.status));
          CHECK(has_speed(result.status) == (max_time == 10 || takes_best_moment(release)));
          if (!has_speed(result.status)) continue;
          swing<E>(m.scene, m.design, solver, {}, fields, alone);
          for (const auto& values : {v, alone}) {
            CHECK(values[0] == Approx(o.least_tension).epsilon(1e-4));
            CHECK(values[1] == Approx(o.peak_tension).epsilon(1e-4));
            CHECK(values[2] == Approx(o.peak_axle_load).epsilon(1e-4));
            CHECK(values[3] == Approx(o.peak_hanger_tension).epsilon(1e-4));
            CHECK(values[4] == Approx(o.lift_off).epsilon(1e-9));
            CHECK(std::abs(values[5]) < 1e-7);  // which includes the losses
          }
          const Mechanism<double, E> mechanism(m.scene, m.design);
          const auto initial = start<double, E>(m.scene, m.design);
          CHECK(o.loss ==
                Approx(mechanism.energy(initial) - mechanism.energy(outcome.x)).epsilon(1e-4));
          CHECK(o.loss > 0);
        }
}

TEST_CASE("Angles and flight at the release follow from its state") {
  constexpr std::array fields{Field::arm_angle,    Field::pin_angle, Field::flight_time,
                              Field::impact_speed, Field::apex,      Field::range,
                              Field::lift_off_time};
  for (const std::string name : {"A", "B", "C", "D", "E"})
    for (const Release release : releases) {
      const Machine m = machine(name);
      const Solver solver = solver_with(release);
      INFO(name << " " << static_cast<int>(release));
      std::array<double, fields.size()> v;
      SwingResult result;
      integrate(m.scene, solver, {{&m.design, 1}, {&result, 1}, fields, v});
      if (!has_speed(result.status)) {
        for (const double value : v) CHECK(std::isnan(value));
        continue;
      }
      with_general_effects(m.scene, [&]<Effects E>() {
        const auto x = swing<E>(m.scene, m.design, solver).x;
        const auto [r1, r3, r2] = m.design;
        const double g = m.scene.gravity, h0 = m.scene.fulcrum_height;
        const double px = -r2 * std::sin(x[phi1]) - r3 * std::sin(x[phi2]);
        const double height = h0 - r2 * std::cos(x[phi1]) - r3 * std::cos(x[phi2]);
        const double vx = -r2 * x[w1] * std::cos(x[phi1]) - r3 * x[w2] * std::cos(x[phi2]);
        const double vy = r2 * x[w1] * std::sin(x[phi1]) + r3 * x[w2] * std::sin(x[phi2]);
        const double time = (vy + std::sqrt(vy * vy + 2 * g * height)) / g;
        const double apex = height + (vy > 0 ? vy * vy / (2 * g) : 0);
        CHECK(result.speed == Approx(std::hypot(vx, vy)).epsilon(1e-6));
        CHECK(v[0] == Approx(x[phi1]).epsilon(1e-6));
        CHECK(v[1] == Approx(x[phi1] - x[phi2]).epsilon(1e-6));
        CHECK(v[2] == Approx(time).epsilon(1e-6));
        CHECK(v[3] == Approx(std::sqrt(vx * vx + vy * vy + 2 * g * height)).epsilon(1e-6));
        CHECK(v[4] == Approx(apex).epsilon(1e-6));
        CHECK(v[5] == Approx(px + vx * time).epsilon(1e-6));
        if (release == Release::pin) CHECK(v[1] == Approx(0.6).epsilon(1e-12));
        if (release == Release::crossing) CHECK(v[0] == Approx(std::acos(-1)).epsilon(1e-14));
      });
    }
}

TEST_CASE("By every rule of release, the results of a design do not depend on its neighbours") {
  constexpr std::array fields{Field::range, Field::lift_off_time, Field::peak_hanger_tension};
  Machine m = machine("D");
  m.scene.pivot_viscosity = 100;
  std::vector<Design<double>> designs;
  for (int i = 0; i < 50; ++i)
    designs.push_back({1.5 + 0.013 * ((i * 7) % 50), 5.1 + 0.09 * ((i * 3) % 50), 8.5 - 0.03 * i});
  for (const std::string stepper : {"euler", "rk4", "dopri5", "vern8"})
    for (const Release release : releases) {
      Solver solver = solver_with(release);
      solver.stepper = stepper;
      solver.max_time = 1.6;
      INFO(stepper << " " << static_cast<int>(release));
      std::vector<SwingResult> results(designs.size());
      std::vector<double> values(designs.size() * fields.size());
      integrate(m.scene, solver, {designs, results, fields, values});
      int released = 0, lifted = 0;
      for (std::size_t i = 0; i < designs.size(); ++i) {
        SwingResult alone;
        std::array<double, fields.size()> v;
        integrate(m.scene, solver, {{&designs[i], 1}, {&alone, 1}, fields, v});
        CHECK(alone.status == results[i].status);
        CHECK(alone.steps == results[i].steps);
        CHECK(std::memcmp(&alone.speed, &results[i].speed, 8) == 0);
        CHECK(std::memcmp(&alone.release_time, &results[i].release_time, 8) == 0);
        CHECK(std::memcmp(v.data(), &values[i * fields.size()], sizeof(v)) == 0);
        released += has_speed(alone.status);
        lifted += alone.status != Status::never_lifted && alone.status != Status::sling_too_short;
      }
      CHECK(released > 5);
      CHECK(lifted > 10);
    }
}
