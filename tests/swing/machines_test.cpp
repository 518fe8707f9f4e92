#include "support/machines.hpp"

#include <cmath>
#include <fstream>
#include <sstream>
#include <vector>

#include "support/catch.hpp"
#include "trebsweep/swing/integrate.hpp"
#include "trebsweep/swing/reference.hpp"
#include "trebsweep/swing/swing.hpp"

using namespace trebsweep;

namespace {

/// A row of machines.csv; NaN where it has no value.
struct Known {
  std::string machine, release;
  double lift_off, time, speed, range;
};

double number_or_nan(const std::string& text) { return text.empty() ? NAN : std::stod(text); }

std::vector<Known> known_swings() {
  std::ifstream file(SOURCE_DIR "/tests/swing/machines.csv");
  std::vector<Known> all;
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::istringstream row(line);
    std::array<std::string, 6> cells;
    for (std::string& cell : cells) std::getline(row, cell, ',');
    all.push_back({cells[0], cells[2], number_or_nan(cells[1]), number_or_nan(cells[3]),
                   number_or_nan(cells[4]), number_or_nan(cells[5])});
  }
  return all;
}

Release release_named(const std::string& name) {
  const auto found = std::find(release_names.begin(), release_names.end(), name);
  return static_cast<Release>(found - release_names.begin());
}

Solver solver_with(Release release, const std::string& stepper = "vern8",
                   double tolerance = 1e-11) {
  Solver solver;
  solver.stepper = stepper;
  solver.tolerance = tolerance;
  solver.release = release;
  if (release == Release::pin) solver.pin_angle = 0.6;
  return solver;
}

constexpr std::array fields_of_machines{Field::lift_off_time, Field::range};

struct Found {
  SwingResult result;
  double lift_off, range;
};

/// By swing().
Found swing_alone(const Machine& m, const Solver& solver) {
  std::array<double, 2> values;
  const SwingResult result = with_general_effects(m.scene, [&]<Effects E>() {
    return result_of(swing<E>(m.scene, m.design, solver, {}, fields_of_machines, values), values);
  });
  return {result, values[0], values[1]};
}

/// By integrate(), in a lane of a pack.
Found swing_in_pack(const Machine& m, const Solver& solver) {
  std::array<double, 2> values;
  SwingResult result;
  integrate(m.scene, solver, {{&m.design, 1}, {&result, 1}, fields_of_machines, values});
  return {result, values[0], values[1]};
}

}  // namespace

TEST_CASE("Swings of known machines agree with three other programs") {
  const auto check = [](const Found& found, const Known& known) {
    const bool best = takes_best_moment(release_named(known.release));
    REQUIRE(found.result.status == Status::released);
    if (!std::isnan(known.lift_off)) CHECK(std::abs(found.lift_off - known.lift_off) < 1e-8);
    CHECK(std::abs(found.result.release_time - known.time) < (best ? 1e-6 : 1e-8));
    CHECK(std::abs(found.result.speed - known.speed) < (best ? 1e-6 : 1e-8));
    if (!std::isnan(known.range)) CHECK(std::abs(found.range - known.range) < 1e-5);
  };
  CHECK(known_swings().size() == 22);
  for (const Known& known : known_swings())
    for (const std::string stepper : {"vern8", "fehlberg78"}) {
      INFO(known.machine << ", " << known.release << ", " << stepper);
      Solver solver = solver_with(release_named(known.release), stepper);
      // The other programs take the largest speed until the arm turns back, whether a pin can
      // release there or not. In C, phi1 - phi2 rises at that moment; D throws faster later.
      if (known.machine == "C" && solver.release == Release::fastest) continue;
      if (solver.release == Release::fastest) solver.max_time = known.time + 0.02;
      check(swing_alone(machine(known.machine), solver), known);
      check(swing_in_pack(machine(known.machine), solver), known);
    }
}

TEST_CASE("Swings of known machines agree with extended precision by every rule of release") {
  for (const std::string name : {"A", "D"})
    for (const Release release :
         {Release::crossing, Release::pin, Release::farthest, Release::fastest}) {
      const Machine m = machine(name);
      const Solver solver = solver_with(release);
      const Reference truth = reference(m.scene, m.design, solver);
      INFO(name << " " << static_cast<int>(release));
      REQUIRE(truth.status == Status::released);
      CHECK(truth.speed_bound < 1e-12);
      CHECK(truth.time_bound < 1e-12);
      for (const Found& found : {swing_alone(m, solver), swing_in_pack(m, solver)}) {
        CHECK(std::abs(found.result.speed - truth.speed) < 1e-9);
        CHECK(std::abs(found.result.release_time - static_cast<double>(truth.release_time)) <
              1e-10);
      }
    }
}

TEST_CASE("A hanger of 1 nm gives the speeds of a fixed counterweight", "[slow]") {
  // From a horizontal arm: otherwise the hanger would swing at 10 kHz from the start, and the arm
  // with it.
  const auto check = [](Machine m, Release release) {
    m.scene.start_angle = std::acos(0.0);
    Solver solver = solver_with(release, "vern8", 1e-7);
    const Found fixed = swing_in_pack(m, solver);
    m.scene.counterweight_hanger = 1e-9;
    const Found hinged = swing_in_pack(m, solver);
    REQUIRE(hinged.result.status == Status::released);
    INFO(static_cast<int>(release) << ", " << hinged.result.steps << " steps");
    CHECK(std::abs(hinged.result.speed - fixed.result.speed) < 1e-6);
  };
  check(machine("B"), Release::crossing);
  for (const Release release : {Release::crossing, Release::pin, Release::farthest})
    check(machine("E"), release);
}

TEST_CASE("A scaled machine has the scaled swing") {
  constexpr double L = 3.7, k = 0.13;  // of lengths and of masses
  for (const std::string name : {"A", "D", "E", "C"})
    for (const Release release :
         {Release::crossing, Release::pin, Release::farthest, Release::fastest}) {
      const Machine m = machine(name);
      Machine scaled = m;
      Scene& s = scaled.scene;
      s.counterweight_mass *= k;
      s.projectile_mass *= k;
      for (double* length : {&s.fulcrum_height, &s.release_height, &s.counterweight_hanger,
                             &s.trough_height, &s.beam_side})
        *length *= L;
      s.beam_density *= k / (L * L * L);
      if (s.beam_mass) {
        *s.beam_mass *= k;
        *s.beam_centre *= L;
        *s.beam_moment *= k * L * L;
      }
      scaled.design = {L * m.design.r1, L * m.design.r3, L * m.design.r2};
      const Solver solver = solver_with(release);
      const Found a = swing_in_pack(m, solver), b = swing_in_pack(scaled, solver);
      INFO(name << " " << static_cast<int>(release));
      REQUIRE(a.result.status == b.result.status);
      if (!has_speed(a.result.status)) continue;
      CHECK(b.result.speed == Approx(std::sqrt(L) * a.result.speed).epsilon(1e-9));
      // An instant of the largest range or speed is less accurate than the range or speed.
      const double time_error = takes_best_moment(release) ? 1e-6 : 1e-9;
      CHECK(b.result.release_time ==
            Approx(std::sqrt(L) * a.result.release_time).epsilon(time_error));
      CHECK(b.range == Approx(L * a.range).epsilon(takes_best_moment(release) ? 1e-6 : 1e-9));
      CHECK(b.lift_off == Approx(std::sqrt(L) * a.lift_off).epsilon(1e-8).margin(1e-12));
    }
}

TEST_CASE("A swing alone has the bits of the same swing in a lattice, by every stepper and rule",
          "[slow]") {
  for (const std::string name : {"A", "B", "D", "E"}) {
    const auto [r1, r3, r2] = machine(name).design;
    std::vector<Design<double>> designs;
    for (int i = 0; i < 40; ++i)
      designs.push_back({r1 + 0.003 * i, r3 - 0.002 * i, r2 - 0.001 * i});
    for (const auto& stepper : stepper_info)
      for (const Release release : {Release::crossing, Release::window, Release::pin,
                                    Release::farthest, Release::fastest}) {
        Solver solver = solver_of(std::string(stepper.name),
                                  stepper.follows_tolerance ? 1e-6 : 4e-3, solver_with(release));
        solver.release = release;
        const Scene& scene = machine(name).scene;
        std::vector<SwingResult> results(designs.size());
        integrate(scene, solver, {designs, results});
        for (std::size_t i = 0; i < designs.size(); i += 8)
          with_general_effects(scene, [&]<Effects E>() {
            INFO(name << " " << stepper.name << " " << static_cast<int>(release) << " " << i);
            double end = 0;
            const auto alone = swing<E>(scene, designs[i], solver,
                                        [&](const auto&, const auto& to) { end = to.t; });
            CHECK(alone.status == results[i].status);
            CHECK(alone.steps == results[i].steps);
            if (!has_speed(alone.status)) return;
            CHECK(alone.speed == results[i].speed);
            CHECK(alone.t == results[i].release_time);
            CHECK(end == alone.t);
          });
      }
  }
}
