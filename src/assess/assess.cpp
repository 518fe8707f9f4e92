#include "trebsweep/assess/assess.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "trebsweep/archive/hdf5.hpp"
#include "trebsweep/archive/output_state.hpp"
#include "trebsweep/archive/partial.hpp"
#include "trebsweep/assess/accuracy.hpp"
#include "trebsweep/assess/cases.hpp"
#include "trebsweep/assess/lattice_error.hpp"
#include "trebsweep/assess/stability.hpp"
#include "trebsweep/base/mpi.hpp"
#include "trebsweep/base/version.hpp"
#include "trebsweep/job/sample.hpp"
#include "trebsweep/ode/steppers.hpp"

namespace trebsweep {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// A solver on a case.
struct Row {
  const Case* scene;
  Solver solver;
  Accuracy accuracy;
  double order;  ///< seen from the row before
};

std::string stepper_text(const Solver& solver) {
  return solver.stepper + (solver.release == Release::window ? ", window" : "");
}

std::string setting_text(const Solver& solver) {
  return fmt::format("{:g}{}", setting(solver), follows_tolerance(solver.stepper) ? "" : " s");
}

/// The solvers to try on a case: its own, as it is; then a ladder for each stepper, or the case's
/// own step and tolerance.
std::vector<Solver> solvers(const Case& c, const Assessment& assess) {
  std::vector<Solver> solvers{c.job.solver};
  for (const std::string& stepper : assess.steppers) {
    const bool adaptive = follows_tolerance(stepper);
    std::vector<double> settings = adaptive ? assess.tolerances : assess.time_steps;
    if (c.extreme) settings = {adaptive ? c.job.solver.tolerance : c.job.solver.time_step};
    for (const double value : settings) solvers.push_back(solver_of(stepper, value, c.job.solver));
  }
  return solvers;
}

/// log(error ratio) / log(ratio of steps) between two rows, if they are of the same ladder.
double ladder_order(const Row& before, const Row& row) {
  if (before.scene != row.scene || stepper_text(before.solver) != stepper_text(row.solver))
    return nan;
  return std::log(before.accuracy.speed.median / row.accuracy.speed.median) /
         std::log(row.accuracy.steps / before.accuracy.steps);
}

std::vector<Row> measure(const std::vector<Case>& cases, const Assessment& assess, MPI_Comm comm) {
  std::vector<Row> rows;
  for (const Case& c : cases)
    for (const Solver& solver : solvers(c, assess)) rows.push_back({&c, solver, {}, nan});
  const auto results = mpi::share(rows.size(), comm, [&](std::size_t i) {
    const Case& c = *rows[i].scene;
    return accuracy(c.job.scene, rows[i].solver, c.designs, c.references,
                    static_cast<int>(assess.repeats));
  });
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i].accuracy = results[i];
    if (i > 0) rows[i].order = ladder_order(rows[i - 1], rows[i]);
  }
  return rows;
}

/// What adds columns to a table, with a value of each item: add(name, units, meaning, items, f).
auto adder(Table& table) {
  return [&](const char* name, const char* units, const char* meaning, const auto& items, auto f,
             bool printed = true) {
    using Value =
        std::conditional_t<std::is_arithmetic_v<decltype(f(*items.begin()))>, double, std::string>;
    std::vector<Value> values;
    for (const auto& item : items) values.push_back(static_cast<Value>(f(item)));
    table.columns.push_back({name, units, meaning, std::move(values), printed});
  };
}

/// "24 released, 1 step_budget"
std::string outcome(const Accuracy& a) {
  std::string text;
  for (std::size_t s = 0; s < a.statuses.size(); ++s)
    if (a.statuses[s] > 0)
      text += fmt::format("{}{:g} {}", text.empty() ? "" : ", ", a.statuses[s], status_names[s]);
  return text;
}

std::string kind(const Solver& solver) { return is_for_packs(solver.stepper) ? "packs" : "single"; }

Table accuracy_table(const std::vector<Row>& rows) {
  Table table{
      "accuracy", "Errors of each solver on a sample of each scene's designs, and their price", {}};
  const auto add = adder(table);
  const auto of = [](auto member) { return [=](const Row& r) { return r.accuracy.*member; }; };
  const auto speed = [](auto member) {
    return [=](const Row& r) { return r.accuracy.speed.*member; };
  };
  const auto relative = [](auto member) {
    return [=](const Row& r) { return r.accuracy.relative.*member; };
  };
  const auto time = [](auto member) {
    return [=](const Row& r) { return r.accuracy.time.*member; };
  };
  add("scene", "", "scene", rows, [](const Row& r) { return r.scene->name; });
  add("stepper", "", "stepper; with the paper's release window, where it says so", rows,
      [](const Row& r) { return stepper_text(r.solver); });
  add("setting", "", "step or tolerance", rows,
      [](const Row& r) { return setting_text(r.solver); });
  add(
      "value", "", "the setting as a number", rows, [](const Row& r) { return setting(r.solver); },
      false);
  add("lanes", "", "packs of designs, or a single one", rows,
      [](const Row& r) { return kind(r.solver); });
  add("outcome", "", "designs of each status", rows,
      [](const Row& r) { return outcome(r.accuracy); });
  for (std::size_t s = 1; s < status_names.size(); ++s)
    add(
        std::string(status_names[s]).c_str(), "1", "designs of that status", rows,
        [=](const Row& r) { return r.accuracy.statuses[s]; }, false);
  add("different", "1", "designs that are a shot here or in the reference, and not in both", rows,
      of(&Accuracy::status_mismatches));
  add("error_median", "m s-1", "error of the speed, median", rows, speed(&ErrorQuantiles::median));
  add("error_p95", "m s-1", "error of the speed, of 95 % below", rows, speed(&ErrorQuantiles::p95));
  add("error_largest", "m s-1", "error of the speed, largest", rows,
      speed(&ErrorQuantiles::largest));
  add("at_floor", "", "* where the median is below the reference's own error", rows,
      [](const Row& r) {
        return std::string(r.accuracy.speed.median <= r.accuracy.reference_error ? "*" : "");
      });
  add("relative_median", "1", "relative error of the speed, median", rows,
      relative(&ErrorQuantiles::median), false);
  add("relative_p95", "1", "relative error of the speed, of 95 % below", rows,
      relative(&ErrorQuantiles::p95), false);
  add("relative_largest", "1", "relative error of the speed, largest", rows,
      relative(&ErrorQuantiles::largest), false);
  add("time_median", "s", "error of the release time, median", rows, time(&ErrorQuantiles::median),
      false);
  add("time_p95", "s", "error of the release time, of 95 % below", rows, time(&ErrorQuantiles::p95),
      false);
  add("time_largest", "s", "error of the release time, largest", rows,
      time(&ErrorQuantiles::largest));
  add("drift", "1", "largest size of the energy drift", rows, of(&Accuracy::drift));
  add("order", "1", "order over steps, from the setting before", rows,
      [](const Row& r) { return r.order; });
  add("steps", "1", "steps tried per design", rows, of(&Accuracy::steps));
  add("evaluations", "1", "right-hand sides per design", rows, of(&Accuracy::evaluations));
  add("seconds", "s", "run time per design", rows, of(&Accuracy::seconds));
  return table;
}

/// How a solver did on a single design: "1.2e-09 in 66" steps, or the status that it ended with, in
/// brackets where the truth is another one.
std::string outcome_of_one(const Row& row) {
  const Accuracy& a = row.accuracy;
  if (a.statuses[static_cast<std::size_t>(Status::released)] == 1 && a.status_mismatches == 0)
    return fmt::format("{:.0e} in {:.5g}", a.speed.largest, a.steps);
  const auto status = std::find(a.statuses.begin(), a.statuses.end(), 1) - a.statuses.begin();
  const std::string_view name = status_names[static_cast<std::size_t>(status)];
  return a.status_mismatches == 0 ? std::string(name) : fmt::format("({})", name);
}

/// The extreme scenes against the solvers, at a glance; of scenes with one design.
Table outcome_table(const std::vector<Case>& cases, const std::vector<Row>& rows) {
  Table table{
      "outcomes",
      "Extreme scenes: the true outcome, and of each solver the error of the speed (m/s) and "
      "the steps, or the status; (in brackets) where it differs",
      {}};
  std::vector<const Case*> extremes;
  for (const Case& c : cases)
    if (c.extreme && c.designs.size() == 1) extremes.push_back(&c);
  if (extremes.empty()) return table;
  const auto add = adder(table);
  add("scene", "", "scene", extremes, [](const Case* c) { return c->name; });
  add("truth", "", "outcome of the reference", extremes, [](const Case* c) {
    const Reference& r = c->references.front();
    return has_speed(r.status) ? fmt::format("{:.6g} m/s", r.speed)
                               : std::string(status_names[static_cast<std::size_t>(r.status)]);
  });
  std::vector<std::string> steppers;
  for (const Row& row : rows)
    if (const std::string stepper = stepper_text(row.solver);
        row.scene == extremes.front() &&
        std::find(steppers.begin(), steppers.end(), stepper) == steppers.end())
      steppers.push_back(stepper);
  for (const std::string& stepper : steppers)
    add(stepper.c_str(), "", "outcome with this stepper", extremes, [&](const Case* c) {
      const auto row = std::find_if(rows.begin(), rows.end(), [&](const Row& r) {
        return r.scene == c && stepper_text(r.solver) == stepper;
      });
      return row == rows.end() ? std::string() : outcome_of_one(*row);
    });
  return table;
}

Table reference_table(const std::vector<Case>& cases) {
  Table table{
      "reference", "References: fehlberg78 in quadruple precision; bounds of their own errors", {}};
  const auto largest = [](const Case& c, double Reference::*member) {
    double most = nan;
    for (const Reference& r : c.references) most = std::fmax(most, r.*member);
    return most;
  };
  const auto add = adder(table);
  add("scene", "", "scene", cases, [](const Case& c) { return c.name; });
  add("designs", "1", "designs of the sample", cases,
      [](const Case& c) { return static_cast<double>(c.designs.size()); });
  add("shots", "1", "designs with a shot", cases, [](const Case& c) {
    return static_cast<double>(
        std::count_if(c.references.begin(), c.references.end(),
                      [](const Reference& r) { return has_speed(r.status); }));
  });
  add("speed_bound", "m s-1", "largest bound of a speed's error", cases,
      [&](const Case& c) { return largest(c, &Reference::speed_bound); });
  add("time_bound", "s", "largest bound of a release time's error", cases,
      [&](const Case& c) { return largest(c, &Reference::time_bound); });
  return table;
}

/// The orders that theory gives; of bulirsch_stoer, a variable one, none.
double order_in_theory(const std::string& stepper) {
  const int order = info_of_stepper(stepper).order;
  return order > 0 ? order : nan;
}

Table order_table(const Case& c, const Assessment& assess, MPI_Comm comm) {
  std::vector<std::string> steppers;
  for (const std::string& stepper : assess.steppers)
    if (!std::isnan(order_in_theory(stepper))) steppers.push_back(stepper);
  const auto seen = mpi::share(steppers.size(), comm, [&](std::size_t i) {
    return observed_order(steppers[i], c.job.scene, c.designs, c.references);
  });
  Table table{"order", "Order of convergence with steps of one length, scene " + c.name, {}};
  const auto add = adder(table);
  add("stepper", "", "stepper", steppers, [](const std::string& s) { return s; });
  add("theory", "1", "order in theory", steppers, order_in_theory);
  add("seen", "1", "order seen, median of the designs", seen, [](double order) { return order; });
  return table;
}

Table growth_table(const Case& c, const Assessment& assess) {
  constexpr double time = 10;
  Table table{"growth",
              fmt::format("A small oscillation of {} about rest, after {:g} s: it should be as it "
                          "was",
                          c.name, time),
              {}};
  if (is_dissipative(c.job.scene) || effects(c.job.scene).elastic) return table;
  std::vector<std::string> steppers;
  std::vector<double> steps;
  std::vector<Growth> growths;
  for (const std::string& stepper : assess.steppers) {
    if (!has_stability_function(stepper)) continue;
    for (const double h : {assess.time_steps.front(), assess.time_steps.back()}) {
      steppers.push_back(stepper);
      steps.push_back(h);
      growths.push_back(growth(stepper, c.job.scene, c.designs.front(), h, time));
    }
  }
  const auto add = adder(table);
  add("stepper", "", "stepper", steppers, [](const std::string& s) { return s; });
  add("step", "s", "length of all steps", steps, [](double h) { return h; });
  add("rate", "rad s-1", "rate of the fastest mode", growths,
      [](const Growth& g) { return g.rate; });
  add("predicted", "1", "factor of the amplitude, by the stability function", growths,
      [](const Growth& g) { return g.predicted; });
  add("seen", "1", "factor of the amplitude, seen", growths,
      [](const Growth& g) { return g.seen; });
  return table;
}

/// A stepper's steps on the stiffest design of a case.
struct Stability {
  Stiffness stiffness;
  double stable, usable;
};

Table stability_table(const std::vector<Case>& cases, const Assessment& assess, MPI_Comm comm) {
  struct StabilityTask {
    const Case* scene;
    std::string stepper;
  };
  std::vector<StabilityTask> tasks;
  for (const Case& c : cases)
    for (const std::string& stepper : assess.steppers)
      if (!c.extreme && has_stability_function(stepper)) tasks.push_back({&c, stepper});
  const auto results = mpi::share(tasks.size(), comm, [&](std::size_t i) {
    const auto& [c, stepper] = tasks[i];
    Stability s{{nan, nan}, nan, nan};
    double most = -1;
    std::vector<Spectrum> stiffest;
    std::size_t design = 0;
    for (std::size_t d = 0; d < c->designs.size(); ++d) {
      if (!has_speed(c->references[d].status)) continue;
      auto all = spectra(c->job.scene, c->designs[d], c->job.solver);
      const double modulus = stiffness(all).modulus;
      if (modulus <= most) continue;
      most = modulus;
      stiffest = std::move(all);
      design = d;
    }
    if (stiffest.empty()) return s;
    s.stiffness = stiffness(stiffest);
    s.stable = largest_stable_step(stepper, stiffest);
    s.usable = largest_usable_step(stepper, c->job.scene, c->designs[design], c->references[design],
                                   s.stable);
    return s;
  });
  Table table{
      "stability", "The largest step that is stable, on the stiffest design of each scene", {}};
  const auto add = adder(table);
  add("scene", "", "scene", tasks, [](const StabilityTask& p) { return p.scene->name; });
  add("stepper", "", "stepper", tasks, [](const StabilityTask& p) { return p.stepper; });
  add("stiffness", "s-1", "largest modulus of an eigenvalue", results,
      [](const Stability& s) { return s.stiffness.modulus; });
  add("decay", "s-1", "largest negative real part of an eigenvalue", results,
      [](const Stability& s) { return s.stiffness.decay; });
  add("stable_step", "s", "largest stable step, by the eigenvalues", results,
      [](const Stability& s) { return s.stable; });
  add("usable_step", "s", "largest step seen with an error below 10 %", results,
      [](const Stability& s) { return s.usable; });
  return table;
}

Table lattice_table(const Case& c, const std::vector<Row>& rows, const Assessment& assess,
                    MPI_Comm comm) {
  Table table{"lattice",
              fmt::format("Errors on the whole lattice of {}, against fehlberg78 at 1e-13", c.name),
              {}};
  const Lattice lattice(c.job.scene, c.job.lattice);
  if (assess.lattice_seconds == 0 || lattice.designs() > 10'000'000) return table;
  const auto designs = all_designs(lattice);
  double seconds = 0;
  const auto truth = lattice_speeds(c.job.scene, solver_of("fehlberg78", 1e-13, c.job.solver),
                                    designs, seconds, comm);
  std::vector<Solver> solvers;
  for (const Row& row : rows)
    if (row.scene == &c && row.accuracy.seconds * static_cast<double>(designs.size()) <
                               assess.lattice_seconds * mpi::size(comm))
      solvers.push_back(row.solver);
  std::vector<LatticeError> errors;
  for (const Solver& solver : solvers)
    errors.push_back(lattice_error(c.job.scene, solver, designs, truth, comm));

  const auto add = adder(table);
  const auto of = [](auto member) { return [=](const LatticeError& e) { return e.*member; }; };
  const auto speed = [](auto member) {
    return [=](const LatticeError& e) { return e.speed.*member; };
  };
  add("stepper", "", "stepper", solvers, stepper_text);
  add("setting", "", "step or tolerance", solvers, setting_text);
  add("seconds", "s", "integration of the lattice, the slowest rank's", errors,
      of(&LatticeError::seconds));
  add("error_median", "m s-1", "error of the speed, median", errors,
      speed(&ErrorQuantiles::median));
  add("error_p95", "m s-1", "error of the speed, of 95 % below", errors,
      speed(&ErrorQuantiles::p95));
  add("error_largest", "m s-1", "error of the speed, largest", errors,
      speed(&ErrorQuantiles::largest));
  add("relative_median", "1", "relative error with its sign, median", errors,
      of(&LatticeError::median_relative));
  add("optimum_error", "m s-1", "error at the true optimum, with its sign", errors,
      of(&LatticeError::optimum_error));
  add("different", "1", "designs that are a shot here or in truth, and not in both", errors,
      of(&LatticeError::status_mismatches));
  add("best_speed", "m s-1", "the solver's fastest shot", errors, of(&LatticeError::best_speed));
  table.columns.back().digits = 8;
  add("best_r1", "m", "and its design", errors, [](const LatticeError& e) { return e.best.r1; });
  add("best_r2", "m", "and its design", errors, [](const LatticeError& e) { return e.best.r2; });
  add("best_r3", "m", "and its design", errors, [](const LatticeError& e) { return e.best.r3; });
  return table;
}

Table advice_table(const std::vector<Case>& cases, const std::vector<Row>& rows, double target) {
  Table table{
      "advice",
      fmt::format("The cheapest solver whose speeds are within {:g} m/s on the sample", target),
      {}};
  std::vector<std::string> names;
  std::vector<const Row*> cheapest;
  for (const Case& c : cases) {
    if (c.extreme) continue;
    const Row* best = nullptr;
    for (const Row& row : rows)
      if (row.scene == &c && row.accuracy.status_mismatches == 0 &&
          row.accuracy.speed.largest <= target &&
          (!best || row.accuracy.seconds < best->accuracy.seconds))
        best = &row;
    names.push_back(c.name);
    cheapest.push_back(best);
  }
  const auto add = adder(table);
  add("scene", "", "scene", names, [](const std::string& name) { return name; });
  add("stepper", "", "stepper", cheapest,
      [](const Row* r) { return r ? stepper_text(r->solver) : std::string("none of these"); });
  add("setting", "", "step or tolerance", cheapest,
      [](const Row* r) { return r ? setting_text(r->solver) : std::string(); });
  add("error_largest", "m s-1", "error of the speed, largest", cheapest,
      [](const Row* r) { return r ? r->accuracy.speed.largest : nan; });
  add("seconds", "s", "run time per design", cheapest,
      [](const Row* r) { return r ? r->accuracy.seconds : nan; });
  return table;
}

void write_file(const OutputState& place, const std::vector<Table>& tables, const Job& job,
                const AssessOptions& options, std::uint64_t ranks) {
  const auto partial = new_path(place.path);  // the lock keeps others from it
  const std::string what = "write " + partial.string();
  hdf5::silence();
  std::filesystem::remove(partial);
  hdf5::File file(H5Fcreate(partial.c_str(), H5F_ACC_EXCL, H5P_DEFAULT, H5P_DEFAULT), what);
  hdf5::check(H5Fflush(file, H5F_SCOPE_GLOBAL), what);  // its signature
  hdf5::write_attribute(file, "title", std::string("Trebuchet assessment"));
  hdf5::write_attribute(file, "source", version_text());
  hdf5::write_attribute(file, "history", history_line(options.command, ranks));
  hdf5::write_attribute(file, "job", to_text(job, true));
  for (const Table& table : tables) write(file, table);
  file.close(what);
  rename_to_final(partial, place.path, place.replaces);
}

}  // namespace

std::vector<Table> assess(const Job& job, const AssessOptions& options, MPI_Comm comm) {
  const bool root = mpi::rank(comm) == 0;
  const double begin = MPI_Wtime();
  const auto tell = [&](const std::string& what) {
    if (root && options.progress) fmt::print(stderr, "{:6.1f} s  {}\n", MPI_Wtime() - begin, what);
  };
  OutputState place;  // on rank 0 alone
  mpi::on_root(comm, [&] { place = reserve_output(job, options.overwrite); });
  std::vector<Case> cases = make_cases(job, comm);
  tell("references in quadruple precision");
  compute_references(cases, comm);
  std::vector<Table> tables{reference_table(cases)};
  tell(fmt::format("{} steppers on {} scenes", job.assess.steppers.size(), cases.size()));
  const std::vector<Row> rows = measure(cases, job.assess, comm);
  std::vector<Row> ladders, extremes;
  for (const Row& row : rows) (row.scene->extreme ? extremes : ladders).push_back(row);
  tables.push_back(accuracy_table(ladders));
  tables.push_back(outcome_table(cases, extremes));
  tables.push_back(accuracy_table(extremes));
  tables.back().name = "extremes";
  for (Column& c : tables.back().columns) c.printed = false;  // at a glance above
  tell("orders of convergence");
  tables.push_back(order_table(cases.front(), job.assess, comm));
  tell("stability");
  tables.push_back(stability_table(cases, job.assess, comm));
  tables.push_back(growth_table(cases.front(), job.assess));
  tell("the whole lattice");
  tables.push_back(lattice_table(cases.front(), rows, job.assess, comm));
  tables.push_back(advice_table(cases, rows, job.assess.target_error));
  mpi::on_root(comm, [&] {
    write_file(place, tables, job, options, static_cast<std::uint64_t>(mpi::size(comm)));
  });
  tell("done");
  return tables;
}

}  // namespace trebsweep
