// The lanes beside their rivals: the same designs, in one run, each solver in turn. Prints tables.
//
//   build/release/tests/benchmarks [DESIGNS [ROUNDS]]

#include <cvode/cvode.h>
#include <fmt/format.h>
#include <gsl/gsl_odeiv2.h>
#include <immintrin.h>
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
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "support/paper_algorithm.hpp"
#include "support/paper_solver.hpp"
#include "trebsweep/job/lattice.hpp"
#include "trebsweep/ode/event.hpp"
#include "trebsweep/ode/step_size.hpp"
#include "trebsweep/swing/integrate.hpp"
#include "trebsweep/swing/kernel.hpp"

using namespace trebsweep;

namespace {

constexpr double pi = boost::math::double_constants::pi;

/// Newton's method for the release, in steps of `step(h)` from a state below pi: the speed there.
template <class Step>
double land(const Design<double>& design, double h, Step step) {
  State<double> x{};
  for (int i = 0; i < 20; ++i) {
    x = step(h);
    if (std::abs(x[phi1] - pi) < 1e-14) break;
    h += (pi - x[phi1]) / x[w1];
  }
  return Mechanism<double>(Scene{}, design).speed(x);
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
    return land(design, t - at, [&](double step) {
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
      land(design, (t - at) * (pi - before[phi1]) / (x[phi1] - before[phi1]), [&](double length) {
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
  return Mechanism<double>(Scene{}, design).speed(end);
}

/// One row of the table.
struct Entry {
  std::string name, setting;
  std::function<void(const std::vector<Design<double>>&, std::vector<double>& speeds)> run;
  std::optional<Solver> lanes = {};  // of the program's own
  std::vector<double> seconds = {};
  std::vector<double> speeds = {};

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

struct LaneSteps {
  double tried, made;  // by swings, and by lanes whether they had one or not
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
                 [](const Design<double>& d) { return paper::shoot(d.r1, d.r3, d.r2).speed; }));
  for (const double tolerance : {1e-6, 1e-9, 1e-11}) {
    const std::string setting = fmt::format("{:g}", tolerance);
    list.push_back(one_by_one("Odeint dopri5, make_controlled", setting,
                              [=](const auto& d) { return shoot_odeint(d, tolerance); }));
    list.push_back(
        one_by_one("GSL rk8pd", setting, [=](const auto& d) { return shoot_gsl(d, tolerance); }));
    list.push_back(one_by_one("SUNDIALS CVODE, Adams", setting,
                              [=](const auto& d) { return shoot_cvode(d, tolerance); }));
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

/// A number that remembers from what it was computed, to count the operations on registers that
/// something takes. As in a pack, a product that is added is one operation, and one by 1 is none.
struct Counted {
  struct Operation {
    int cost;
    std::vector<Counted> operands;
  };
  std::shared_ptr<const Operation> from = {};
  bool one = false;

  struct Product {
    std::shared_ptr<const Operation> multiply;
    bool by_one;
  };

  Counted() = default;
  Counted(double x) : one(x == 1) {}
  Counted(const Product& p) : from(p.multiply) {}
  Counted(int cost, std::vector<Counted> operands)
      : from(std::make_shared<Operation>(Operation{cost, std::move(operands)})) {}

  friend Product operator*(const Counted& a, const Counted& b) {
    const bool by_one = a.one || b.one;
    return {Counted(by_one ? 0 : 1, {a, b}).from, by_one};
  }
  /// A sum with a product, which becomes a part of it.
  static Counted fused(const Product& p, const Counted& c) {
    return {p.by_one ? 1 : p.multiply->cost, {p.multiply->operands[0], p.multiply->operands[1], c}};
  }
  friend Counted operator+(const Counted& a, const Counted& b) { return {1, {a, b}}; }
  friend Counted operator-(const Counted& a, const Counted& b) { return {1, {a, b}}; }
  friend Counted operator-(const Counted& a) { return {1, {a}}; }
  friend Counted operator+(const Product& p, const Counted& c) { return fused(p, c); }
  friend Counted operator-(const Product& p, const Counted& c) { return fused(p, c); }
  friend Counted operator+(const Counted& c, const Product& p) { return fused(p, c); }
  friend Counted operator-(const Counted& c, const Product& p) { return fused(p, c); }
  friend Counted operator+(const Product& p, const Product& q) { return fused(q, p); }
  friend Counted operator-(const Product& p, const Product& q) { return fused(q, p); }
  friend Counted operator/(const Counted&, const Counted&) { return {}; }  // of constants alone
  Counted& operator+=(const Counted& b) { return *this = *this + b; }
  Counted& operator+=(const Product& b) { return *this = *this + b; }
  // A comparison's result is as good as a number.
  friend Counted operator<(const Counted& a, const Counted& b) { return {1, {a, b}}; }
  friend Counted operator<=(const Counted& a, const Counted& b) { return {1, {a, b}}; }
  friend Counted operator>(const Counted& a, const Counted& b) { return {1, {a, b}}; }
  friend Counted select(const Counted& m, const Counted& a, const Counted& b) {
    return {1, {m, a, b}};
  }
  friend Counted abs(const Counted& a) { return {1, {a}}; }
  // Counted by hand in pack.hpp and sin_cos.hpp, for AVX-512.
  friend Counted quotient(const Counted& a, const Counted& b) { return {10, {a, b}}; }
  friend Counted rough_power(const Counted& a, const Counted& b, double) { return {22, {a, b}}; }
  friend SinCos<Counted> sin_cos(const Counted& x) {
    const Counted both(26, {x});
    return {Counted(0, {both}), Counted(0, {both})};
  }
};

/// Adds up the operations behind a number that are not yet in `seen`.
int operations(const Counted& x, std::set<const Counted::Operation*>& seen) {
  if (!x.from || !seen.insert(x.from.get()).second) return 0;
  int sum = x.from->cost;
  for (const Counted& operand : x.from->operands) sum += operations(operand, seen);
  return sum;
}

}  // namespace

template <>
struct trebsweep::Lanes<Counted> {
  using Number = double;
  static constexpr std::size_t count = 1;
};

namespace {

/// Operations on registers that a step takes, with its control; what comes to nothing is left out,
/// as the compiler does.
template <class Stepper>
int operations_per_step() {
  const Instant<Counted> from{};
  Instant<Counted> to;
  State<Counted> error;
  Stepper stepper;
  advance(stepper, Motion<Counted>(), from, Counted(), to, error);
  std::vector<Counted> results{to.t};
  for (const auto& part : {to.x, to.at, to.dxdt})
    results.insert(results.end(), part.begin(), part.end());
  if constexpr (is_adaptive<Stepper>) {
    const auto ratio = error_ratio(from, to, error, Counted(), 1e-9);
    results.push_back(Counted() * step_factor(ratio, stepper.error_order()));
    results.push_back(ratio.error <= ratio.allowed);
  }
  std::set<const Counted::Operation*> seen;
  int sum = 0;
  for (const Counted& x : results) sum += operations(x, seen);
  return sum;
}

/// Seconds per fused multiply-add of AVX-512 registers at the machine's best: many independent
/// ones, the best of some rounds.
__attribute__((target("avx512f"))) double seconds_per_operation() {
  constexpr int chains = 12, length = 1000, rounds = 2000;
  const __m512d half = _mm512_set1_pd(0.5);
  double best = 1;
  for (int round = 0; round < rounds; ++round) {
    __m512d x[chains];
    for (__m512d& y : x) y = half;
    const auto before = std::chrono::steady_clock::now();
    for (int i = 0; i < length; ++i)
      for (__m512d& y : x) y = _mm512_fmadd_pd(y, half, half);
    const std::chrono::duration<double> time = std::chrono::steady_clock::now() - before;
    for (const __m512d& y : x) asm volatile("" : : "m"(y));  // must be computed
    best = std::min(best, time.count() / (chains * length));
  }
  return best;
}

const Entry& find(const std::vector<Entry>& list, std::string_view name, std::string_view setting) {
  return *std::find_if(list.begin(), list.end(), [&](const Entry& entry) {
    return entry.name == name && entry.setting == setting;
  });
}

void print_lanes(const std::vector<Entry>& list, const std::vector<Design<double>>& designs) {
  // The hand-counted operations are those of AVX-512; elsewhere, no limit is given.
  const bool limited = instruction_set().starts_with("AVX-512");
  const double operation = limited ? seconds_per_operation() / 8 : 0;
  fmt::print(
      "\n| lanes | setting | steps tried per design | lanes at work | ns per step and lane | "
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
               entry.setting, steps, 100 * tried / made, 1e9 * entry.median() / steps,
               1e9 * operation * count, count);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::size_t wanted = argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 20000;
  const int rounds = argc > 2 ? std::atoi(argv[2]) : 5;
  const auto designs = sample(std::max<std::size_t>(wanted, 1));
  std::vector<double> truth(designs.size());
  run_lanes(crossing("fehlberg78", 1e-13), designs, truth);

  auto list = entries();
  for (int round = 0; round < std::max(rounds, 1); ++round)
    for (Entry& entry : list) {
      entry.speeds.resize(designs.size());
      const auto before = std::chrono::steady_clock::now();
      entry.run(designs, entry.speeds);
      const std::chrono::duration<double> time = std::chrono::steady_clock::now() - before;
      entry.seconds.push_back(time.count() / static_cast<double>(designs.size()));
    }

  const double paper = find(list, "the paper's algorithm, plain C++", "0.01 s").median();
  const double odeint = find(list, "Odeint dopri5, make_controlled", "1e-09").median();
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
  print_lanes(list, designs);
}
