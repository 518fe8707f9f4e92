// Compares the program's SIMD lanes with other solvers on the same designs, in one run, each solver
// in turn. Prints tables.
//
//   build/release/tests/benchmarks [DESIGNS [ROUNDS]]

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "benchmarks/operation_count.hpp"
#include "benchmarks/rivals.hpp"
#include "support/paper_algorithm.hpp"
#include "support/paper_solver.hpp"
#include "trebsweep/assess/error_quantiles.hpp"
#include "trebsweep/job/sample.hpp"
#include "trebsweep/swing/integrate.hpp"
#include "trebsweep/swing/kernel.hpp"

using namespace trebsweep;

namespace {

/// A row of the table.
struct Entry {
  std::string name, setting;
  std::function<void(const std::vector<Design<double>>&, std::vector<double>& speeds)> run;
  std::optional<Solver> lanes = {};  // only for this program's solvers
  std::vector<double> seconds = {};  // per design, of each round
  std::vector<double> speeds = {};

  double median_seconds() const { return error_quantiles(seconds).median; }
};

template <class F>
Entry one_by_one(std::string name, std::string setting, F speed_of) {
  return {std::move(name), std::move(setting),
          [speed_of](const std::vector<Design<double>>& designs, std::vector<double>& speeds) {
            std::transform(designs.begin(), designs.end(), speeds.begin(), speed_of);
          }};
}

struct LaneSteps {
  double tried;  // by swings
  double made;   // by lanes, including idle ones
};

LaneSteps run_lanes(const Solver& solver, const std::vector<Design<double>>& designs,
                    std::vector<double>& speeds) {
  std::vector<SwingResult> results(designs.size());
  const auto made = integrate(Scene{}, solver, {designs, results}).lane_steps;
  double tried = 0;
  for (std::size_t i = 0; i < results.size(); ++i) {
    speeds[i] = results[i].speed;
    tried += static_cast<double>(results[i].steps);
  }
  return {tried, static_cast<double>(made)};
}

Solver crossing(const std::string& stepper, double tolerance) {
  Solver solver;
  solver.stepper = stepper;
  solver.tolerance = tolerance;
  solver.release = Release::crossing;
  return solver;
}

std::vector<Entry> entries() {
  std::vector<Entry> list;
  list.push_back(
      one_by_one("the paper's algorithm, plain C++", "0.01 s",
                 [](const Design<double>& d) { return paper::swing(d.r1, d.r3, d.r2).speed; }));
  for (const double tolerance : {1e-6, 1e-9, 1e-11}) {
    const std::string setting = fmt::format("{:g}", tolerance);
    list.push_back(one_by_one("Odeint dopri5, make_controlled", setting,
                              [=](const auto& d) { return rivals::odeint_speed(d, tolerance); }));
    list.push_back(one_by_one("GSL rk8pd", setting,
                              [=](const auto& d) { return rivals::gsl_speed(d, tolerance); }));
    list.push_back(one_by_one("SUNDIALS CVODE, Adams", setting,
                              [=](const auto& d) { return rivals::cvode_speed(d, tolerance); }));
  }
  const auto lanes = [&](const std::string& setting, const Solver& solver) {
    list.push_back({"lanes, " + solver.stepper, setting,
                    [=](const auto& designs, auto& speeds) { run_lanes(solver, designs, speeds); },
                    solver});
  };
  lanes("0.01 s", paper_solver());
  for (const double step : {0.01, 0.001}) {
    Solver solver = crossing("rk4", 0);
    solver.time_step = step;
    lanes(fmt::format("{:g} s", step), solver);
  }
  for (const std::string stepper : {"cash_karp54", "dopri5", "fehlberg78", "vern7", "vern8"})
    for (const double tolerance : {1e-6, 1e-9, 1e-11})
      lanes(fmt::format("{:g}", tolerance), crossing(stepper, tolerance));
  return list;
}

/// About as many designs as wanted, evenly spaced in the paper's lattice.
std::vector<Design<double>> spread_designs(std::size_t wanted) {
  const auto all = all_designs(Lattice(Scene{}, LatticeSpec{}));
  const std::size_t stride = std::max<std::size_t>(1, all.size() / wanted);
  std::vector<Design<double>> designs;
  for (std::size_t i = 0; i < all.size(); i += stride) designs.push_back(all[i]);
  return designs;
}

const Entry& find(const std::vector<Entry>& list, std::string_view name, std::string_view setting) {
  return *std::find_if(list.begin(), list.end(), [&](const Entry& entry) {
    return entry.name == name && entry.setting == setting;
  });
}

void print_lanes(const std::vector<Entry>& list, const std::vector<Design<double>>& designs) {
  // Operations are counted for AVX-512; for other instruction sets the limit is printed as 0.
  const bool limited = instruction_set().starts_with("AVX-512");
  const double operation = limited ? seconds_per_operation() / 8 : 0;
  fmt::print(
      "\n| lanes | setting | steps tried per design | lane utilisation | ns per step and lane | "
      "limit | operations |\n|---|---|---|---|---|---|---|\n");
  std::vector<double> speeds(designs.size());
  for (const Entry& entry : list) {
    if (!entry.lanes) continue;
    const auto [tried, made] = run_lanes(*entry.lanes, designs, speeds);
    const double steps = tried / static_cast<double>(designs.size());
    const int count = with_pack_stepper(
        entry.lanes->stepper, []<template <class, Effects = Effects{}> class Stepper>() {
          return operations_per_step<Stepper<Counted>>();
        });
    fmt::print("| {} | {} | {:.1f} | {:.1f} % | {:.2f} | {:.2f} | {} |\n", entry.lanes->stepper,
               entry.setting, steps, 100 * tried / made, 1e9 * entry.median_seconds() / steps,
               1e9 * operation * count, count);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::size_t wanted = argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 20000;
  const int rounds = argc > 2 ? std::atoi(argv[2]) : 5;
  const auto designs = spread_designs(std::max<std::size_t>(wanted, 1));
  std::vector<double> truth(designs.size());
  run_lanes(crossing("vern8", 1e-13), designs, truth);

  auto list = entries();
  for (int round = 0; round < std::max(rounds, 1); ++round)
    for (Entry& entry : list) {
      entry.speeds.resize(designs.size());
      const auto before = std::chrono::steady_clock::now();
      entry.run(designs, entry.speeds);
      const std::chrono::duration<double> time = std::chrono::steady_clock::now() - before;
      entry.seconds.push_back(time.count() / static_cast<double>(designs.size()));
    }

  const double paper = find(list, "the paper's algorithm, plain C++", "0.01 s").median_seconds();
  const double odeint = find(list, "Odeint dopri5, make_controlled", "1e-09").median_seconds();
  fmt::print("{} designs of the paper's lattice on one core, {} rounds in turn, medians; {}\n\n",
             designs.size(), rounds, instruction_set());
  fmt::print(
      "| solver | setting | designs/s | median error, m/s | largest, m/s | x the paper's | "
      "x Odeint's 1e-9 |\n|---|---|---|---|---|---|---|\n");
  for (const Entry& entry : list) {
    std::vector<double> errors;
    for (std::size_t i = 0; i < truth.size(); ++i)
      errors.push_back(std::abs(entry.speeds[i] - truth[i]));
    const auto [median, p95, largest] = error_quantiles(std::move(errors));
    const double time = entry.median_seconds();
    fmt::print("| {} | {} | {:.3g} | {:.1e} | {:.1e} | {:.2f} | {:.2f} |\n", entry.name,
               entry.setting, 1 / time, median, largest, paper / time, odeint / time);
  }
  print_lanes(list, designs);
}
