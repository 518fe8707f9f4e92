#include <cmath>
#include <vector>

#include "support/catch.hpp"
#include "support/machines.hpp"
#include "support/sampled_swing.hpp"
#include "trebsweep/swing/integrate.hpp"
#include "trebsweep/swing/swing.hpp"

using namespace trebsweep;

namespace {

constexpr Effects fixed{.pivot = true, .trough = true};
constexpr Effects hinged{.pivot = true, .hanger = true, .trough = true};

Solver solver_with(const std::string& stepper, double setting) {
  return solver_of(stepper, setting, {});
}

/// The result of one design and its lift-off, computed in a pack.
struct Lifted {
  SwingResult result;
  double lift_off;
};

Lifted swing_of(const Machine& m, const Solver& solver) {
  Lifted lifted;
  const Field field = Field::lift_off_time;
  integrate(m.scene, solver,
            {{&m.design, 1}, {&lifted.result, 1}, {&field, 1}, {&lifted.lift_off, 1}});
  return lifted;
}

template <Effects E>
using Steps = std::vector<std::pair<Instant<double, E>, Instant<double, E>>>;

template <Effects E>
Steps<E> steps_of(const Machine& m, const Solver& solver) {
  Steps<E> steps;
  swing<E>(m.scene, m.design, solver,
           [&](const auto& from, const auto& to) { steps.emplace_back(from, to); });
  return steps;
}

/// A machine whose arm first turns forwards and back: its counterweight is too light to lift the
/// projectile.
Machine too_heavy_projectile() {
  Machine m = machine("A");
  m.scene.projectile_mass = 40;
  return m;
}

}  // namespace

TEST_CASE("Speeds of fixed steps converge across the lift-off with the order of the method") {
  struct Case {
    std::string stepper;
    double step, order;
  };
  for (const std::string name : {"A", "D", "E"}) {
    const Machine m = machine(name);
    const double truth = swing_of(m, solver_of("vern8", 1e-12, {})).result.speed;
    for (const auto& [stepper, step, order] :
         {Case{"euler", 8e-5, 1}, Case{"modified_midpoint", 4e-3, 2}, Case{"rk4", 8e-3, 4}}) {
      const auto error = [&](double h) {
        return std::abs(swing_of(m, solver_of(stepper, h, {})).result.speed - truth);
      };
      INFO(name << ", " << stepper);
      CHECK(std::log2(error(step) / error(step / 8)) / 3 == Approx(order).epsilon(0.125));
    }
  }
}

TEST_CASE("Speeds of adaptive steps converge across the lift-off with their number") {
  for (const std::string name : {"A", "D", "E"}) {
    const Machine m = machine(name);
    const double truth = swing_of(m, solver_of("fehlberg78", 1e-13, {})).result.speed;
    for (const std::string stepper : {"cash_karp54", "dopri5", "fehlberg78", "vern7", "vern8"}) {
      const auto coarse = swing_of(m, solver_of(stepper, 1e-6, {})).result;
      const auto fine = swing_of(m, solver_of(stepper, 1e-11, {})).result;
      const double ratio = std::abs(coarse.speed - truth) / std::abs(fine.speed - truth);
      INFO(name << ", " << stepper << ": " << coarse.steps << " and " << fine.steps << " steps");
      CHECK(ratio > std::pow(static_cast<double>(fine.steps) / static_cast<double>(coarse.steps),
                             info_of_stepper(stepper).order - 0.5));
    }
  }
}

TEST_CASE("Energy is kept, and the projectile at its height while it slides") {
  const auto check = []<Effects E>(const Machine& m, double tolerance) {
    const Mechanism<double, E> mechanism(m.scene, m.design);
    const auto steps = steps_of<E>(m, solver_of("vern8", tolerance, {}));
    const double lift_off = swing_of(m, solver_of("vern8", tolerance, {})).lift_off;
    const auto initial = steps.front().first.x;
    const double released =
        mechanism.potential_energy(initial) - mechanism.potential_energy(steps.back().second.x);
    double sliding = 0, flying = 0, height = 0, left = 0;
    int before = 0, after = 0;
    for (const auto& [from, to] : steps) {
      const double drift = std::abs(mechanism.energy(to.x) - mechanism.energy(initial)) / released;
      const double rise = mechanism.projectile(to.x).y - mechanism.projectile(initial).y;
      if (to.t <= lift_off) {
        ++before;
        sliding = std::max(sliding, drift);
        height = std::max(height, std::abs(rise));
      } else {
        ++after;
        flying = std::max(flying, drift);
        left = std::max(left, rise);
      }
    }
    CHECK(before > 1);
    CHECK(after > 2);
    CHECK(sliding < 100 * tolerance);
    CHECK(flying < 100 * tolerance);
    CHECK(height < 100 * tolerance * m.design.r3);
    CHECK(left > 0.1 * m.design.r3);
  };
  for (const double tolerance : {1e-6, 1e-9, 1e-12}) {
    check.operator()<hinged>(machine("A"), tolerance);
    check.operator()<hinged>(machine("D"), tolerance);
    check.operator()<fixed>(machine("E"), tolerance);
  }
}

TEST_CASE("The projectile lifts off when the normal force first is zero", "[slow]") {
  int lifted = 0, turned = 0;
  const auto check = [&]<Effects E>(const Machine& m) {
    constexpr double max_time = 4;
    SampledSwing<E> swing(m.scene, m.design, 1e-4);
    bool turns = false;
    const bool lifts = swing.slide([](const auto& at) { return max_time - at.t; },
                                   [&](const auto& at) { turns |= at.x[w1] < 0; });
    lifted += lifts;
    turned += lifts && turns;
    for (const std::string stepper : {"vern8", "fehlberg78", "dopri5", "rk4"}) {
      Solver solver = solver_with(stepper, stepper == "rk4" ? 1e-4 : 1e-10);
      solver.max_time = max_time;
      solver.release = Release::fastest;  // the only rule that releases whatever follows
      const Lifted found = swing_of(m, solver);
      INFO(stepper << " " << m.design.r1 << " " << m.design.r3 << " " << m.design.r2 << ", "
                   << m.scene.projectile_mass << " kg, status " << name_of(found.result.status)
                   << ", lift-off " << found.lift_off << " and " << swing.now().t);
      CHECK(name_of(found.result.status) == (lifts ? "released" : "never_lifted"));
      if (lifts) CHECK(std::abs(found.lift_off - swing.now().t) < 1e-8);
    }
  };
  for (const double r1 : {0.8, 1.2})
    for (const double r3 : {0.8, 1.3})
      for (const double r2 : {0.9, 1.1})
        for (const double mass : {1.0, 30.0, 60.0}) {
          const auto changed = [&](Machine m) {
            m.design = {r1 * m.design.r1, r3 * m.design.r3, r2 * m.design.r2};
            m.scene.projectile_mass *= mass;
            return m;
          };
          check.operator()<hinged>(changed(machine("A")));
          check.operator()<fixed>(changed(machine("E")));
        }
  INFO(lifted << " " << turned);
  CHECK(lifted > 20);
  CHECK(turned > 3);
}

TEST_CASE("A trough that does not carry the projectile at the start is left at once") {
  // The horizontal arm drops the tip's end of the sling faster than the projectile could fall.
  Machine m = machine("E");
  m.scene.start_angle = 1.0;
  m.scene.trough_height =
      m.scene.fulcrum_height - m.design.r2 * std::cos(1.0) - m.design.r3 * 0.999;
  m.scene.projectile_mass = 1;
  const Lifted found = swing_of(m, solver_with("vern8", 1e-9));
  SampledSwing<fixed> sampled(m.scene, m.design, 1e-4);
  CHECK_FALSE(sampled.is_sliding());
  REQUIRE(found.result.status == Status::released);
  CHECK(found.lift_off == 0);
  // The same as a swing without a trough from the same sling angle.
  Machine free = m;
  free.scene.trough = false;
  free.scene.sling_angle = start<double, fixed>(m.scene, m.design)[phi2];
  CHECK(swing_of(free, solver_with("vern8", 1e-9)).result.speed ==
        Approx(found.result.speed).epsilon(1e-8));
}

TEST_CASE("A sling that does not reach the trough has a status") {
  Machine m = machine("E");
  const double height = start_above_trough(m.scene, m.design);
  for (const auto& [length, status] : {std::pair(height * (1 - 1e-9), Status::sling_too_short),
                                       std::pair(height * (1 + 1e-9), Status::released)}) {
    m.design.r3 = length;
    const Lifted found = swing_of(m, solver_with("vern8", 1e-9));
    CHECK(name_of(found.result.status) == name_of(status));
    CHECK(std::isnan(found.lift_off) == (status != Status::released));
    const auto alone = swing<fixed>(m.scene, m.design, solver_with("rk4", 1e-3));
    CHECK(name_of(alone.status) == name_of(status));
  }
}

TEST_CASE("A projectile that stays in the trough until the swing ends is never_lifted") {
  for (const std::string stepper : {"euler", "rk4", "dopri5", "vern8"})
    for (const Release release :
         {Release::crossing, Release::pin, Release::farthest, Release::fastest}) {
      Solver solver = solver_with(stepper, stepper == "euler" || stepper == "rk4" ? 1e-3 : 1e-8);
      solver.release = release;
      solver.pin_angle = 0.6;
      INFO(stepper << " " << static_cast<int>(release));
      // Too heavy: the arm turns back while the projectile slides.
      solver.max_time = 1.5;
      const auto slow =
          swing<hinged>(too_heavy_projectile().scene, too_heavy_projectile().design, solver);
      CHECK(name_of(slow.status) == "never_lifted");
      CHECK(slow.t == Approx(1.5).epsilon(1e-12));
      // The time limit is before the lift-off, also if that is within the same fixed step.
      const Machine m = machine("A");
      for (const double time : {0.1, 0.25, 0.2532914}) {
        solver.max_time = time;
        const auto early = swing<hinged>(m.scene, m.design, solver);
        INFO(time);
        CHECK(name_of(early.status) == "never_lifted");
        CHECK(early.t <= time);
        const Lifted lane = swing_of(m, solver);
        CHECK(name_of(lane.result.status) == "never_lifted");
        CHECK(std::isnan(lane.lift_off));
      }
      solver.max_time = 0.26;
      CHECK(name_of(swing<hinged>(m.scene, m.design, solver).status) ==
            (takes_best_moment(release) ? "released" : "not_released"));
    }
}

TEST_CASE("An arm that reaches the angle of release in the trough has no release") {
  Solver solver;
  solver.release_angle = 0.7;
  for (const std::string stepper : {"rk4", "vern8"}) {
    solver.stepper = stepper;
    const auto outcome = swing<hinged>(machine("A").scene, machine("A").design, solver);
    CHECK(name_of(outcome.status) == "never_lifted");
    CHECK(outcome.x[phi1] >= 0.7);
    CHECK(outcome.t < 0.2532);
  }
}

TEST_CASE("Fixed steps after the lift-off begin there, and end by the time limit") {
  const Machine m = machine("A");
  for (const std::string stepper : {"euler", "rk4"}) {
    Solver solver = solver_with(stepper, 3e-3);
    solver.max_time = 0.5;
    const auto steps = steps_of<hinged>(m, solver);
    double lift_off;
    const Field field = Field::lift_off_time;
    swing<hinged>(m.scene, m.design, solver_with(stepper, 3e-3), {}, {&field, 1}, {&lift_off, 1});
    std::size_t n = 0;
    while (steps[n].second.t != lift_off) {
      REQUIRE(n < steps.size());
      CHECK(steps[n].second.t == static_cast<double>(n + 1) * 3e-3);
      ++n;
    }
    CHECK(steps[n].second.t - steps[n].first.t <= 3e-3);
    for (std::size_t i = n + 1; i < steps.size(); ++i)
      CHECK(steps[i].second.t == lift_off + static_cast<double>(i - n) * 3e-3);
    CHECK(steps.back().second.t <= 0.5);
    const auto outcome = swing<hinged>(m.scene, m.design, solver);
    CHECK(outcome.status == Status::not_released);
    CHECK(outcome.t <= 0.5);
    CHECK(outcome.t > 0.5 - 3.001e-3);
    CHECK(swing_of(m, solver).result.status == Status::not_released);
    // A release is found up to the limit.
    solver.max_time = 10;
    const double release = swing_of(m, solver).result.release_time;
    for (const double after : {-1e-4, 1e-4}) {
      solver.max_time = release + after;
      CHECK(has_speed(swing_of(m, solver).result.status) == (after > 0));
      CHECK(has_speed(swing<hinged>(m.scene, m.design, solver).status) == (after > 0));
    }
  }
}

TEST_CASE("Steps are counted, and limited, across the lift-off") {
  const Machine m = machine("A");
  for (const std::string stepper : {"rk4", "dopri5", "vern8"}) {
    Solver solver = solver_with(stepper, stepper == "rk4" ? 3e-3 : 1e-9);
    const auto all = swing<hinged>(m.scene, m.design, solver);
    std::uint64_t accepted = steps_of<hinged>(m, solver).size();
    CHECK(all.steps >= accepted);
    if (stepper == "rk4") CHECK(all.steps == accepted);
    CHECK(swing_of(m, solver).result.steps == all.steps);
    for (std::uint64_t limit = 1; limit <= all.steps + 1; ++limit) {
      solver.max_steps = limit;
      INFO(stepper << " " << limit << " of " << all.steps);
      const auto alone = swing<hinged>(m.scene, m.design, solver);
      const auto lane = swing_of(m, solver).result;
      const Status expected = limit < all.steps ? Status::step_budget : Status::released;
      CHECK(name_of(alone.status) == name_of(expected));
      CHECK(name_of(lane.status) == name_of(expected));
      CHECK(alone.steps == std::min(limit, all.steps));
      CHECK(lane.steps == std::min(limit, all.steps));
    }
  }
}

TEST_CASE("Fixed steps that are far too long do not turn at ever shorter intervals") {
  Machine m;
  m.design.r3 = 0.4;
  m.scene.start_angle = 0.8;
  m.scene.counterweight_hanger = 0.3;
  m.scene.trough = true;
  m.scene.trough_height = 0.8;
  m.scene.pivot_friction = 300;
  for (const std::string stepper : {"euler", "modified_midpoint", "rk4"}) {
    Solver solver = solver_with(stepper, 0.02);
    solver.release = Release::farthest;
    solver.max_time = 0.75;
    const auto steps_of_time = static_cast<std::uint64_t>(solver.max_time / solver.time_step);
    for (m.design.r1 = 0.51; m.design.r1 < 1.2; m.design.r1 += 0.03)
      for (m.design.r2 = 0.4; m.design.r2 < 0.9; m.design.r2 += 0.02) {
        INFO(stepper << " " << m.design.r1 << " " << m.design.r2);
        CHECK(swing_of(m, solver).result.steps < 2 * steps_of_time);
      }
  }
}

TEST_CASE("Dry friction holds a beam in the trough") {
  Machine m = machine("A");
  m.scene.pivot_friction = 1e4;
  for (const std::string stepper : {"euler", "rk4", "fehlberg78", "vern8", "dopri5"}) {
    Solver solver = solver_with(stepper, follows_tolerance(stepper) ? 1e-9 : 1e-2);
    solver.max_time = 2;
    const auto held = swing<hinged>(m.scene, m.design, solver);
    INFO(stepper);
    CHECK(name_of(held.status) == "never_lifted");
    CHECK(held.x == start<double, hinged>(m.scene, m.design));
    CHECK(name_of(swing_of(m, solver).result.status) == "never_lifted");
  }
}

TEST_CASE("A projectile that slides through below the arm's tip keeps its energy") {
  // There, the arm turns back, against dry friction.
  Machine m = too_heavy_projectile();
  m.scene.pivot_friction = 5;
  const Mechanism<double, hinged> mechanism(m.scene, m.design);
  const auto initial = start<double, hinged>(m.scene, m.design);
  double loss = 0;  // by the short steps of rk4
  for (const std::string stepper : {"rk4", "dopri5", "vern8"}) {
    Solver solver = solver_with(stepper, stepper == "rk4" ? 1e-4 : 1e-10);
    solver.max_time = 1.4;
    int turns = 0;
    const auto end =
        swing<hinged>(m.scene, m.design, solver, [&](const auto& from, const auto& to) {
          if (stepper == "rk4")
            loss += m.scene.pivot_friction * std::abs(to.x[phi1] - from.x[phi1]);
          turns += from.x[w1] > 0 && to.x[w1] < 0;
        });
    INFO(stepper);
    CHECK(name_of(end.status) == "never_lifted");
    CHECK(turns == 1);
    CHECK(mechanism.energy(initial) - mechanism.energy(end.x) == Approx(loss).epsilon(1e-4));
    CHECK(mechanism.projectile(end.x).y == Approx(mechanism.projectile(initial).y).margin(1e-6));
  }
}
