// The lanes beside their rivals: the same designs, in one run, each solver in turn. Prints tables.
//
//   build/release/tests/benchmarks [DESIGNS [ROUNDS]]

#include <cvode/cvode.h>
#include <fmt/format.h>
#include <gsl/gsl_odeiv2.h>
#include <nvector/nvector_serial.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include <algorithm>
#include <boost/numeric/odeint/stepper/controlled_runge_kutta.hpp>
#include <boost/numeric/odeint/stepper/generation/generation_controlled_runge_kutta.hpp>
#include <boost/numeric/odeint/stepper/generation/generation_runge_kutta_dopri5.hpp>
#include <boost/numeric/odeint/stepper/generation/make_controlled.hpp>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

#include "paper_algorithm.hpp"
#include "trebsweep/kernel.hpp"
#include "trebsweep/lattice.hpp"
#include "trebsweep/swing.hpp"

using namespace trebsweep;

namespace {

constexpr double pi = boost::math::double_constants::pi;

/// Newton's method for the release, in steps of `step(h)` from a state below pi: the speed there.
template <class Step>
double land(const Motion<double>& motion, double h, Step step) {
  State<double> x{};
  for (int i = 0; i < 20; ++i) {
    x = step(h);
    if (std::abs(x[phi1] - pi) < 1e-14) break;
    h += (pi - x[phi1]) / x[w1];
  }
  return motion.speed(x);
}

/// Odeint as its manual shows it.
using PlainDopri5 = odeint::runge_kutta_dopri5<State<double>>;

double shoot_odeint(const Design<double>& design, double tolerance) {
  const Motion<double> motion(Scene{}, design);
  const auto system = std::cref(motion);
  auto stepper = odeint::make_controlled(tolerance, tolerance, PlainDopri5());
  State<double> x = start(Scene{}, design);
  double t = 0, h = 0.01;
  for (;;) {
    const State<double> before = x;
    const double at = t;
    while (stepper.try_step(system, x, t, h) == odeint::fail) {
    }
    if (x[phi1] < pi) continue;
    return land(motion, t - at, [&](double step) {
      PlainDopri5 plain;  // a new one: it keeps the rates of its last step
      State<double> to = before;
      plain.do_step(system, to, at, step);
      return to;
    });
  }
}

int gsl_rates(double, const double x[], double dxdt[], void* motion) {
  State<double> rates;
  (*static_cast<Motion<double>*>(motion))({x[0], x[1], x[2], x[3]}, rates, 0);
  std::copy(rates.begin(), rates.end(), dxdt);
  return 0;
}

double shoot_gsl(const Design<double>& design, double tolerance) {
  Motion<double> motion(Scene{}, design);
  gsl_odeiv2_system system{gsl_rates, nullptr, 4, &motion};
  gsl_odeiv2_step* step = gsl_odeiv2_step_alloc(gsl_odeiv2_step_rk8pd, 4);
  gsl_odeiv2_control* control = gsl_odeiv2_control_y_new(tolerance, tolerance);
  gsl_odeiv2_evolve* evolve = gsl_odeiv2_evolve_alloc(4);
  State<double> x = start(Scene{}, design), before = x;
  double t = 0, h = 0.01, at = 0;
  while (x[phi1] < pi) {
    before = x;
    at = t;
    gsl_odeiv2_evolve_apply(evolve, control, step, &system, &t, 10, &h, x.data());
  }
  const double speed =
      land(motion, (t - at) * (pi - before[phi1]) / (x[phi1] - before[phi1]), [&](double length) {
        State<double> to = before, error;
        gsl_odeiv2_step_reset(step);
        gsl_odeiv2_step_apply(step, at, length, to.data(), error.data(), nullptr, nullptr, &system);
        return to;
      });
  gsl_odeiv2_evolve_free(evolve);
  gsl_odeiv2_control_free(control);
  gsl_odeiv2_step_free(step);
  return speed;
}

int cvode_rates(double t, N_Vector x, N_Vector dxdt, void* motion) {
  return gsl_rates(t, N_VGetArrayPointer(x), N_VGetArrayPointer(dxdt), motion);
}

int cvode_event(double, N_Vector x, double* event, void*) {
  *event = N_VGetArrayPointer(x)[phi1] - pi;
  return 0;
}

double shoot_cvode(const Design<double>& design, double tolerance) {
  Motion<double> motion(Scene{}, design);
  const State<double> at_rest = start(Scene{}, design);
  SUNContext context;
#if SUNDIALS_VERSION_MAJOR >= 7
  SUNContext_Create(SUN_COMM_NULL, &context);
#else
  SUNContext_Create(nullptr, &context);
#endif
  N_Vector x = N_VNew_Serial(4, context);
  std::copy(at_rest.begin(), at_rest.end(), N_VGetArrayPointer(x));
  void* cvode = CVodeCreate(CV_ADAMS, context);
  CVodeInit(cvode, cvode_rates, 0, x);
  CVodeSStolerances(cvode, tolerance, tolerance);
  CVodeSetUserData(cvode, &motion);
  CVodeSetMaxNumSteps(cvode, 100000);
  SUNNonlinearSolver solver = SUNNonlinSol_FixedPoint(x, 0, context);
  CVodeSetNonlinearSolver(cvode, solver);
  CVodeRootInit(cvode, 1, cvode_event);
  double t = 0;
  CVode(cvode, 10, x, &t, CV_NORMAL);
  State<double> end;
  std::copy_n(N_VGetArrayPointer(x), 4, end.begin());
  SUNNonlinSolFree(solver);
  CVodeFree(&cvode);
  N_VDestroy(x);
  SUNContext_Free(&context);
  return motion.speed(end);
}

/// One row of the table.
struct Entry {
  std::string name, setting;
  std::function<void(const std::vector<Design<double>>&, std::vector<double>& speeds)> run;
  bool scalar_odeint = false, paper = false, lanes = false;
  std::vector<double> seconds = {};
  std::vector<double> speeds = {};
  double steps = 0, utilisation = 0;  // of lanes: tried per design, share of lane steps

  double median() const {
    std::vector<double> sorted = seconds;
    std::nth_element(sorted.begin(), sorted.begin() + static_cast<long>(sorted.size() / 2),
                     sorted.end());
    return sorted[sorted.size() / 2];
  }
};

template <class F>
Entry one_by_one(std::string name, std::string setting, F shoot) {
  return {std::move(name), std::move(setting),
          [shoot](const std::vector<Design<double>>& designs, std::vector<double>& speeds) {
            std::transform(designs.begin(), designs.end(), speeds.begin(), shoot);
          }};
}

void run_lanes(const Solver& solver, const std::vector<Design<double>>& designs,
               std::vector<double>& speeds, Entry* entry) {
  std::vector<Shot> shots(designs.size());
  const std::uint64_t lane_steps = integrate(Scene{}, solver, designs, shots);
  double steps = 0;
  for (std::size_t i = 0; i < shots.size(); ++i) {
    speeds[i] = shots[i].speed;
    steps += static_cast<double>(shots[i].steps);
  }
  if (!entry) return;
  entry->steps = steps / static_cast<double>(shots.size());
  entry->utilisation = steps / static_cast<double>(lane_steps);
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
                 [](const Design<double>& d) { return paper::shoot(d.r1, d.r3, d.r2).speed; }));
  list.back().paper = true;
  for (const double tolerance : {1e-6, 1e-9, 1e-11}) {
    const std::string setting = fmt::format("{:g}", tolerance);
    list.push_back(one_by_one("Odeint dopri5, make_controlled", setting,
                              [=](const auto& d) { return shoot_odeint(d, tolerance); }));
    list.back().scalar_odeint = tolerance == 1e-9;
    list.push_back(
        one_by_one("GSL rk8pd", setting, [=](const auto& d) { return shoot_gsl(d, tolerance); }));
    list.push_back(one_by_one("SUNDIALS CVODE, Adams", setting,
                              [=](const auto& d) { return shoot_cvode(d, tolerance); }));
  }
  const auto lanes = [&](const std::string& setting, const Solver& solver) {
    Entry entry{"lanes, " + solver.stepper, setting, [solver](const auto& designs, auto& speeds) {
                  run_lanes(solver, designs, speeds, nullptr);
                }};
    entry.lanes = true;
    list.push_back(entry);
  };
  lanes("0.01 s", Solver{});
  for (const double step : {0.01, 0.001}) {
    Solver solver = crossing("rk4", 0);
    solver.time_step = step;
    lanes(fmt::format("{:g} s", step), solver);
  }
  for (const std::string stepper : {"cash_karp54", "dopri5", "fehlberg78"})
    for (const double tolerance : {1e-6, 1e-9, 1e-11})
      lanes(fmt::format("{:g}", tolerance), crossing(stepper, tolerance));
  return list;
}

/// Every n-th design of the paper's lattice.
std::vector<Design<double>> sample(std::size_t wanted) {
  const Lattice lattice(Scene{}, LatticeSpec{});
  const std::uint64_t every = std::max<std::uint64_t>(1, lattice.designs() / wanted);
  std::vector<Design<double>> designs;
  std::uint64_t number = 0;
  const Index3 n = lattice.extent();
  for (std::size_t a = 0; a < n[0]; ++a)
    for (std::size_t b = 0; b < n[1]; ++b)
      for (std::size_t c = 0; c < n[2]; ++c)
        if (lattice.holds({a, b, c}) && number++ % every == 0)
          designs.push_back(lattice.design({a, b, c}));
  return designs;
}

}  // namespace

int main(int argc, char** argv) {
  const std::size_t wanted = argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 20000;
  const int rounds = argc > 2 ? std::atoi(argv[2]) : 5;
  const auto designs = sample(std::max<std::size_t>(wanted, 1));
  std::vector<double> truth(designs.size());
  run_lanes(crossing("fehlberg78", 1e-13), designs, truth, nullptr);

  auto list = entries();
  for (int round = 0; round < std::max(rounds, 1); ++round)
    for (Entry& entry : list) {
      entry.speeds.resize(designs.size());
      const auto before = std::chrono::steady_clock::now();
      entry.run(designs, entry.speeds);
      const std::chrono::duration<double> time = std::chrono::steady_clock::now() - before;
      entry.seconds.push_back(time.count() / static_cast<double>(designs.size()));
    }

  double paper = 0, odeint = 0;
  for (const Entry& entry : list) {
    if (entry.paper) paper = entry.median();
    if (entry.scalar_odeint) odeint = entry.median();
  }
  fmt::print("{} designs of the paper's lattice on one core, {} rounds in turn, medians; {}\n\n",
             designs.size(), rounds, instruction_set());
  fmt::print(
      "| solver | setting | designs/s | median error, m/s | largest, m/s | x the paper's | "
      "x Odeint's 1e-9 |\n|---|---|---|---|---|---|---|\n");
  for (const Entry& entry : list) {
    std::vector<double> errors;
    for (std::size_t i = 0; i < truth.size(); ++i)
      errors.push_back(std::abs(entry.speeds[i] - truth[i]));
    std::sort(errors.begin(), errors.end());
    const double time = entry.median();
    fmt::print("| {} | {} | {:.3g} | {:.1e} | {:.1e} | {:.2f} | {:.2f} |\n", entry.name,
               entry.setting, 1 / time, errors[errors.size() / 2], errors.back(), paper / time,
               odeint / time);
  }
  fmt::print(
      "\n| lanes | setting | steps tried per design | ns per step and lane | lanes at work "
      "|\n|---|---|---|---|---|\n");
  std::vector<double> speeds(designs.size());
  const auto account = [&](const std::string& setting, const Solver& solver) {
    for (const Entry& entry : list) {
      if (entry.name != "lanes, " + solver.stepper || entry.setting != setting) continue;
      Entry counted = entry;
      run_lanes(solver, designs, speeds, &counted);
      fmt::print("| {} | {} | {:.1f} | {:.2f} | {:.1f} % |\n", solver.stepper, setting,
                 counted.steps, 1e9 * entry.median() / counted.steps * 1.0,
                 100 * counted.utilisation);
    }
  };
  account("0.01 s", Solver{});
  for (const std::string stepper : {"cash_karp54", "dopri5", "fehlberg78"})
    for (const double tolerance : {1e-6, 1e-9, 1e-11})
      account(fmt::format("{:g}", tolerance), crossing(stepper, tolerance));
}
