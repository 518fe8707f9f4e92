#include "trebsweep/assess/assessment_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include "trebsweep/ode/stepper_info.hpp"

namespace trebsweep {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

std::string setting_text(const Solver& solver) {
  return fmt::format("{:g}{}", setting(solver), follows_tolerance(solver.stepper) ? "" : " s");
}

/// "24 released, 1 step_budget"
std::string statuses_text(const MeasuredAccuracy& a) {
  std::string text;
  for (std::size_t s = 0; s < a.statuses.size(); ++s)
    if (a.statuses[s] > 0)
      text += fmt::format("{}{:g} {}", text.empty() ? "" : ", ", a.statuses[s], status_names[s]);
  return text;
}

/// The outcome of a single design: its speed error (m/s) and steps as "1e-09 in 66", or the name
/// of its status, in brackets if the reference has a release and the solver has not, or vice versa.
std::string outcome_text(const MeasuredAccuracy& a) {
  if (a.statuses[static_cast<std::size_t>(Status::released)] == 1 && a.status_mismatches == 0)
    return fmt::format("{:.0e} in {:.5g}", a.speed.largest, a.steps);
  const auto status = std::find(a.statuses.begin(), a.statuses.end(), 1) - a.statuses.begin();
  const std::string_view name = status_names[static_cast<std::size_t>(status)];
  return a.status_mismatches == 0 ? std::string(name) : fmt::format("({})", name);
}

std::string outcome_text(const Reference& r) {
  return has_speed(r.status) ? fmt::format("{:.6g} m/s", r.speed) : std::string(name_of(r.status));
}

/// Adds the columns PREFIX_median, PREFIX_p95 and PREFIX_largest of the ErrorQuantiles f(item).
template <class Items, class F>
void add_quantiles(Table& table, const std::string& prefix, const std::string& units,
                   const std::string& meaning, const Items& items, F f, bool printed = true) {
  const auto add = [&](const char* name, const char* quantile, auto member) {
    table.add_column({.name = prefix + name,
                      .units = units,
                      .meaning = fmt::format("{}, {}", meaning, quantile),
                      .printed = printed},
                     items, [=](const auto& item) { return f(item).*member; });
  };
  add("_median", "median", &ErrorQuantiles::median);
  add("_p95", "95th percentile", &ErrorQuantiles::p95);
  add("_largest", "largest", &ErrorQuantiles::largest);
}

}  // namespace

Table reference_table(const std::vector<Case>& cases) {
  Table table{"reference",
              "References: vern8 in extended precision, with bounds of their own errors"};
  const auto largest = [](double Reference::*member) {
    return [=](const Case& c) {
      double bound = nan;
      for (const Reference& r : c.references) bound = std::fmax(bound, r.*member);
      return bound;
    };
  };
  const auto releases = [](const Case& c) {
    return std::count_if(c.references.begin(), c.references.end(),
                         [](const Reference& r) { return has_speed(r.status); });
  };
  table.add_column({"scene", "", "scene"}, cases, &Case::name);
  table.add_column({"designs", "1", "designs in the sample"}, cases,
                   [](const Case& c) { return c.designs.size(); });
  table.add_column({"releases", "1", "designs with a release"}, cases, releases);
  table.add_column({"speed_bound", "m s-1", "largest error bound of a speed"}, cases,
                   largest(&Reference::speed_bound));
  table.add_column({"time_bound", "s", "largest error bound of a release time"}, cases,
                   largest(&Reference::time_bound));
  return table;
}

Table accuracy_table(const std::string& name, const std::vector<Measurement>& measured) {
  Table table{name, "Errors of each solver, and its cost, on a sample of each scene's designs"};
  const auto add = [&](const char* column, const char* units, const char* meaning,
                       auto f) -> Column& {
    return table.add_column({column, units, meaning}, measured, f);
  };
  const auto of = [](auto member) {
    return [=](const Measurement& m) { return m.accuracy.*member; };
  };
  add("scene", "", "scene", [](const Measurement& m) { return m.test_case->name; });
  add("stepper", "", "stepper; \"window\" if it uses the paper's release window",
      [](const Measurement& m) { return stepper_text(m.solver); });
  add("setting", "", "time step or tolerance",
      [](const Measurement& m) { return setting_text(m.solver); });
  add("value", "", "time step (s) or tolerance, as a number", [](const Measurement& m) {
    return setting(m.solver);
  }).printed = false;
  add("lanes", "", "packs: a design per SIMD lane; single: one design at a time",
      [](const Measurement& m) { return is_for_packs(m.solver.stepper) ? "packs" : "single"; });
  add("outcome", "", "number of designs with each status",
      [](const Measurement& m) { return statuses_text(m.accuracy); });
  for (std::size_t s = 1; s < status_names.size(); ++s)
    table
        .add_column({std::string(status_names[s]), "1", "number of designs with this status"},
                    measured, [=](const Measurement& m) { return m.accuracy.statuses[s]; })
        .printed = false;
  add("different", "1", "designs with a release here but not in the reference, or vice versa",
      of(&MeasuredAccuracy::status_mismatches));
  add_quantiles(table, "error", "m s-1", "error of the speed", measured,
                of(&MeasuredAccuracy::speed));
  add("at_floor", "", "* if the median error of the speed is within the reference's own error",
      [](const Measurement& m) {
        return m.accuracy.speed.median <= m.accuracy.reference_error ? "*" : "";
      });
  add_quantiles(table, "relative", "1", "relative error of the speed", measured,
                of(&MeasuredAccuracy::relative), false);
  add_quantiles(table, "time", "s", "error of the release time", measured,
                of(&MeasuredAccuracy::time), false);
  table.columns.back().printed = true;  // time_largest
  add("drift", "1", "largest magnitude of the energy drift", of(&MeasuredAccuracy::drift));
  add("order", "1", "observed order of convergence since the previous setting",
      &Measurement::order);
  add("steps", "1", "steps tried per design", of(&MeasuredAccuracy::steps));
  add("evaluations", "1", "evaluations of the right-hand side per design",
      of(&MeasuredAccuracy::evaluations));
  add("seconds", "s", "run time per design", of(&MeasuredAccuracy::seconds));
  return table;
}

Table outcome_table(const std::vector<Case>& cases, const std::vector<Measurement>& measured) {
  Table table{"outcomes",
              "Extreme scenes: the true outcome, and each solver's speed error (m/s) and steps, or "
              "its status; in brackets, an outcome that differs from the true one"};
  std::vector<const Case*> extremes;
  for (const Case& c : cases)
    if (c.extreme && c.designs.size() == 1) extremes.push_back(&c);
  if (extremes.empty()) return table;
  table.add_column({"scene", "", "scene"}, extremes, [](const Case* c) { return c->name; });
  table.add_column({"truth", "", "outcome of the reference"}, extremes,
                   [](const Case* c) { return outcome_text(c->references.front()); });
  std::vector<std::string> steppers;
  for (const Measurement& m : measured)
    if (const std::string stepper = stepper_text(m.solver);
        m.test_case == extremes.front() &&
        std::find(steppers.begin(), steppers.end(), stepper) == steppers.end())
      steppers.push_back(stepper);
  for (const std::string& stepper : steppers)
    table.add_column({stepper, "", "outcome with this stepper"}, extremes, [&](const Case* c) {
      const auto m = std::find_if(measured.begin(), measured.end(), [&](const Measurement& each) {
        return each.test_case == c && stepper_text(each.solver) == stepper;
      });
      return m == measured.end() ? std::string() : outcome_text(m->accuracy);
    });
  return table;
}

Table order_table(const Case& c, const std::vector<ConvergenceOrder>& orders) {
  Table table{"order", "Order of convergence with steps of equal length, scene " + c.name};
  table.add_column({"stepper", "", "stepper"}, orders, &ConvergenceOrder::stepper);
  table.add_column({"theory", "1", "theoretical order"}, orders, &ConvergenceOrder::theory);
  table.add_column({"seen", "1", "observed order, median over the designs"}, orders,
                   &ConvergenceOrder::observed);
  return table;
}

Table stability_table(const std::vector<StepLimitMeasurement>& measured) {
  Table table{"stability", "The largest step that is stable on the stiffest design of each scene"};
  const auto add = [&](const char* column, const char* units, const char* meaning, auto f) {
    table.add_column({column, units, meaning}, measured, f);
  };
  add("scene", "", "scene", [](const auto& m) { return m.test_case->name; });
  add("stepper", "", "stepper", &StepLimitMeasurement::stepper);
  add("stiffness", "s-1", "largest modulus of an eigenvalue",
      [](const auto& m) { return m.limits.stiffness.modulus; });
  add("decay", "s-1", "largest negative real part of an eigenvalue",
      [](const auto& m) { return m.limits.stiffness.decay; });
  add("stable_step", "s", "largest stable step according to the eigenvalues",
      [](const auto& m) { return m.limits.stable; });
  add("usable_step", "s", "largest step observed to have an error below 10 %",
      [](const auto& m) { return m.limits.usable; });
  return table;
}

Table growth_table(const Case& c, const std::optional<std::vector<OscillationGrowth>>& growths) {
  Table table{"growth", fmt::format("A small oscillation of {} about its equilibrium, after {:g} s "
                                    "(its exact amplitude is constant)",
                                    c.name, oscillation_time)};
  if (!growths) return table;
  const auto add = [&](const char* column, const char* units, const char* meaning, auto f) {
    table.add_column({column, units, meaning}, *growths, f);
  };
  add("stepper", "", "stepper", &OscillationGrowth::stepper);
  add("step", "s", "length of each step", &OscillationGrowth::h);
  add("rate", "rad s-1", "angular frequency of the fastest mode",
      [](const auto& g) { return g.growth.rate; });
  add("predicted", "1", "growth factor of the amplitude according to the stability function",
      [](const auto& g) { return g.growth.predicted; });
  add("seen", "1", "observed growth factor of the amplitude",
      [](const auto& g) { return g.growth.observed; });
  return table;
}

Table lattice_table(const Case& c, const std::optional<std::vector<LatticeMeasurement>>& measured) {
  Table table{"lattice", fmt::format("Errors on the whole lattice of {}, relative to vern8 at "
                                     "a tolerance of 1e-13",
                                     c.name)};
  if (!measured) return table;
  const auto add = [&](const char* column, const char* units, const char* meaning,
                       auto f) -> Column& {
    return table.add_column({column, units, meaning}, *measured, f);
  };
  const auto of = [](auto member) {
    return [=](const LatticeMeasurement& m) { return m.error.*member; };
  };
  add("stepper", "", "stepper", [](const auto& m) { return stepper_text(m.solver); });
  add("setting", "", "time step or tolerance",
      [](const auto& m) { return setting_text(m.solver); });
  add("seconds", "s", "integration time of the slowest rank", of(&LatticeError::seconds));
  add_quantiles(table, "error", "m s-1", "error of the speed", *measured, of(&LatticeError::speed));
  add("relative_median", "1", "signed relative error, median", of(&LatticeError::median_relative));
  add("optimum_error", "m s-1", "signed error at the true optimum",
      of(&LatticeError::optimum_error));
  add("different", "1", "designs with a release here but not in the reference, or vice versa",
      of(&LatticeError::status_mismatches));
  add("best_speed", "m s-1", "the solver's largest speed", of(&LatticeError::best_speed)).digits =
      8;
  add("best_r1", "m", "r1 of the largest speed", [](const auto& m) { return m.error.best.r1; });
  add("best_r2", "m", "r2 of the largest speed", [](const auto& m) { return m.error.best.r2; });
  add("best_r3", "m", "r3 of the largest speed", [](const auto& m) { return m.error.best.r3; });
  return table;
}

Table advice_table(const std::vector<Case>& cases, const std::vector<Measurement>& measured,
                   double target) {
  struct Advice {
    std::string scene;
    const Measurement* fastest;  // null if no solver reaches the target
  };
  std::vector<Advice> advice;
  for (const Case& c : cases) {
    if (c.extreme) continue;
    const Measurement* fastest = nullptr;
    for (const Measurement& m : measured)
      if (m.test_case == &c && m.accuracy.status_mismatches == 0 &&
          m.accuracy.speed.largest <= target &&
          (!fastest || m.accuracy.seconds < fastest->accuracy.seconds))
        fastest = &m;
    advice.push_back({c.name, fastest});
  }
  Table table{
      "advice",
      fmt::format("The cheapest solver whose speeds are within {:g} m/s on the sample", target)};
  table.add_column({"scene", "", "scene"}, advice, &Advice::scene);
  table.add_column({"stepper", "", "stepper"}, advice, [](const Advice& a) {
    return a.fastest ? stepper_text(a.fastest->solver) : "none of these";
  });
  table.add_column({"setting", "", "time step or tolerance"}, advice, [](const Advice& a) {
    return a.fastest ? setting_text(a.fastest->solver) : "";
  });
  table.add_column(
      {"error_largest", "m s-1", "error of the speed, largest"}, advice,
      [](const Advice& a) { return a.fastest ? a.fastest->accuracy.speed.largest : nan; });
  table.add_column({"seconds", "s", "run time per design"}, advice,
                   [](const Advice& a) { return a.fastest ? a.fastest->accuracy.seconds : nan; });
  return table;
}

}  // namespace trebsweep
