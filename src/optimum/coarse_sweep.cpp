#include "trebsweep/optimum/coarse_sweep.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "trebsweep/base/error.hpp"
#include "trebsweep/base/mpi.hpp"
#include "trebsweep/job/sample.hpp"
#include "trebsweep/optimum/design_problem.hpp"
#include "trebsweep/optimum/field_values.hpp"
#include "trebsweep/swing/integrate.hpp"

namespace trebsweep {
namespace {

constexpr std::size_t enough_values = 200;  // of an axis
constexpr std::uint64_t max_designs = 100'000'000;

/// An objective and a violation of the constraints, as of a Point; infinite where nothing is
/// released or the violation is not known.
struct Merit {
  double objective, violation;
};

/// Computes values of designs on all ranks and reports the progress.
class RankedValues {
 public:
  RankedValues(const Job& job, std::size_t total, ProgressStyle style, MPI_Comm comm)
      : job_(job), comm_(comm), progress_(0, total, style) {}

  /// The values of fields at designs, a column per design. Collective.
  Eigen::MatrixXd operator()(std::span<const Design<double>> designs,
                             std::span<const Field> fields) {
    const auto ranks = static_cast<std::size_t>(mpi::size(comm_));
    const std::size_t rows = fields.size(), count = designs.size();
    // Small parts, since designs of one region may take longer than others.
    const std::size_t part = std::clamp<std::size_t>(count / (8 * ranks), 64, 2048);
    std::vector<double> all(rows * count);
    for (auto first = part * static_cast<std::size_t>(mpi::rank(comm_)); first < count;
         first += part * ranks) {
      const auto some = designs.subspan(first, std::min(part, count - first));
      const Eigen::MatrixXd values =
          field_values(job_.scene, job_.solver, Accuracy::coarse, some, fields);
      std::copy_n(values.data(), values.size(),
                  all.begin() + static_cast<std::ptrdiff_t>(rows * first));
      progress_.update(done_ + std::min(first + part * ranks, count));
    }
    mpi::merge(std::span(all), comm_);
    done_ += count;
    return Eigen::Map<const Eigen::MatrixXd>(all.data(), static_cast<Eigen::Index>(rows),
                                             static_cast<Eigen::Index>(count));
  }

 private:
  const Job& job_;
  MPI_Comm comm_;
  Progress progress_;
  std::size_t done_ = 0;
};

LatticeSpec with_increment(LatticeSpec spec, double increment) {
  spec.increment = increment;
  for (auto* axis : {&spec.r1, &spec.r3, &spec.r2})
    if (*axis && (*axis)->first < (*axis)->last) {
      const double width = (*axis)->last - (*axis)->first;
      (*axis)->step = width / std::max(1.0, std::ceil(width / increment - 1e-6));
    }
  return spec;
}

/// The place of each design in the lattice's bounding box; `none` for a cell without one.
constexpr std::size_t none = static_cast<std::size_t>(-1);
std::vector<std::size_t> places(const Lattice& lattice) {
  const auto [n1, n3, n2] = lattice.extent();
  std::vector<std::size_t> place(n1 * n3 * n2, none);
  std::size_t design = 0;
  for (std::size_t row = 0; row < n1 * n3; ++row)
    for (std::size_t i2 = 0; i2 < lattice.row_length(row % n3); ++i2)
      place[row * n2 + i2] = design++;
  return place;
}

/// The designs that none of their neighbours exceeds, best first; of equal neighbours, the first.
std::vector<std::size_t> local_maxima(const Lattice& lattice, const std::vector<Merit>& merit) {
  const std::vector<std::size_t> place = places(lattice);
  const Index3 n = lattice.extent();
  const auto exceeds_neighbours = [&](std::size_t i1, std::size_t i3, std::size_t i2,
                                      std::size_t design) {
    for (std::size_t k = 0; k < 27; ++k) {
      const std::size_t j1 = i1 + k / 9 - 1, j3 = i3 + k / 3 % 3 - 1, j2 = i2 + k % 3 - 1;
      if (j1 >= n[0] || j3 >= n[1] || j2 >= n[2]) continue;  // below 0 is above n
      const std::size_t other = place[(j1 * n[1] + j3) * n[2] + j2];
      if (other == none || other == design) continue;
      if (is_better(merit[other], merit[design]) ||
          (other < design && !is_better(merit[design], merit[other])))
        return false;
    }
    return true;
  };
  std::vector<std::size_t> maxima;
  for (std::size_t cell = 0; cell < place.size(); ++cell)
    if (place[cell] != none && std::isfinite(merit[place[cell]].violation) &&
        exceeds_neighbours(cell / n[2] / n[1], cell / n[2] % n[1], cell % n[2], place[cell]))
      maxima.push_back(place[cell]);
  std::ranges::stable_sort(
      maxima, [&](std::size_t a, std::size_t b) { return is_better(merit[a], merit[b]); });
  return maxima;
}

bool is_about_release_time(const Job& job) {
  return job.optimum.objective == Field::release_time ||
         std::ranges::count(fields_of(job.optimum.constraints), Field::release_time) > 0;
}

/// The violations of designs, each relative to the scale_of() the constraint; NaN without a
/// release.
std::vector<double> violations_of(const std::vector<Constraint>& constraints, const Scene& scene,
                                  std::span<const Design<double>> designs, RankedValues& values_of,
                                  std::vector<std::uint64_t>& violations) {
  const std::vector<Field> fields = fields_of(constraints);
  std::vector<double> worst;
  const Eigen::MatrixXd all = values_of(designs, fields);
  for (std::size_t n = 0; n < designs.size(); ++n) {
    const Operands operands{
        scene, designs[n], fields, {all.data() + n * fields.size(), fields.size()}};
    double& largest = worst.emplace_back(0);
    for (std::size_t c = 0; c < constraints.size(); ++c) {
      const double by = violation(constraints[c], constraints[c].expression.value(operands)) /
                        scale_of(constraints[c], scene, 0);
      violations[c] += !(by <= feasibility_tolerance);
      largest = std::isnan(by) ? by : std::max(largest, by);
    }
  }
  return worst;
}

/// Sets the violations of designs, in descending order of their objectives, until some of them
/// satisfy the constraints: a design far below the best of these seldom leads to the optimum. Until
/// then, every third design below the best quarter is checked. Adds to `violations` how
/// many designs violate each constraint, and returns how many it checked. Collective.
std::uint64_t find_violations(const Job& job, std::span<const Design<double>> designs,
                              RankedValues& values_of, std::vector<Merit>& merit,
                              std::vector<std::uint64_t>& violations) {
  std::vector<std::size_t> order;
  for (std::size_t n = 0; n < designs.size(); ++n)
    if (std::isfinite(merit[n].objective)) order.push_back(n);
  std::ranges::stable_sort(order, std::greater{},
                           [&](std::size_t n) { return merit[n].objective; });

  const std::vector<Constraint> constraints = constraints_of(job);
  const std::size_t part = std::max<std::size_t>(2048, order.size() / 16);
  std::size_t enough = order.size();
  bool found = false;
  std::uint64_t checked = 0;
  for (std::size_t first = 0; first < enough; first += part) {
    const std::size_t stride = found || first < order.size() / 4 ? 1 : 3;
    std::vector<std::size_t> some;
    std::vector<Design<double>> chosen;
    for (std::size_t k = first; k < std::min(first + part, order.size()); k += stride) {
      some.push_back(order[k]);
      chosen.push_back(designs[order[k]]);
    }
    checked += chosen.size();
    const auto worst = violations_of(constraints, job.scene, chosen, values_of, violations);
    for (std::size_t k = 0; k < some.size(); ++k) {
      merit[some[k]].violation = std::isnan(worst[k]) ? HUGE_VAL : worst[k];
      if (!is_feasible(merit[some[k]])) continue;
      enough = std::min(enough, 2 * (first + k * stride) + order.size() / 4);
      found = true;
    }
  }
  return checked;
}

}  // namespace

CoarsePlan plan_coarse_sweep(const Job& job) {
  constexpr std::uint64_t sampled = 500, fewest = 4'000, most = 300'000;
  constexpr double affordable_steps = 1e6;  // a second or two
  // Few designs with short arms may take most of the steps: the sample is one of a fine lattice.
  const std::vector<Design<double>> designs =
      sample(Lattice(job.scene, coarse_lattice(job.scene, job.lattice, most)), sampled);
  std::vector<SwingResult> results(designs.size());
  Solver solver = coarse_solver(job.solver);
  integrate(job.scene, solver, {designs, results});

  std::vector<double> times;  // of releases
  for (const SwingResult& result : results)
    if (has_speed(result.status)) times.push_back(result.release_time);
  if (!times.empty() && !is_about_release_time(job)) {
    constexpr double late = 3;
    const auto median = times.begin() + std::ssize(times) / 2;
    std::ranges::nth_element(times, median);
    solver.max_time = std::min(solver.max_time, late * *median);
    integrate(job.scene, solver, {designs, results});
  }
  double steps = 0;
  for (const SwingResult& result : results) steps += static_cast<double>(result.steps);
  const double affordable = affordable_steps * static_cast<double>(designs.size()) / (steps + 1);
  return {solver.max_time, affordable > static_cast<double>(most)
                               ? most
                               : std::max(fewest, static_cast<std::uint64_t>(affordable))};
}

LatticeSpec coarse_lattice(const Scene& scene, const LatticeSpec& spec,
                           std::uint64_t enough_designs) {
  std::optional<LatticeSpec> chosen;
  std::uint64_t most = 0;
  for (int exponent = 3; exponent > -7; --exponent)
    for (const double digit : {5.0, 4.0, 3.0, 2.5, 2.0, 1.5, 1.25, 1.0}) {
      const LatticeSpec candidate = with_increment(spec, digit * std::pow(10, exponent));
      try {
        const Lattice lattice(scene, candidate);
        if (chosen && (lattice.designs() > enough_designs ||
                       std::ranges::max(lattice.extent()) > enough_values))
          return *chosen;
        if (lattice.designs() > most) chosen = candidate;
        most = lattice.designs();
      } catch (const InputError&) {
        // An axis without a value: the increment is too large.
      }
    }
  if (!chosen) Lattice(scene, spec);  // says what is wrong
  return chosen.value_or(spec);
}

std::optional<LatticeSpec> edge_lattice(const Scene& scene, const LatticeSpec& coarse) {
  if (coarse.r1) return std::nullopt;
  constexpr int parts = 8;  // of the increment
  const double low = arm_bounds(scene).low, step = coarse.increment / parts;
  LatticeSpec edge = coarse;
  edge.r1 = {low + step, low + (parts - 1) * step, step};
  return edge;
}

CoarseSweep coarse_sweep(const Job& job, const LatticeSpec& spec, ProgressStyle style,
                         MPI_Comm comm) {
  const Lattice lattice(job.scene, spec);
  if (lattice.designs() > max_designs)
    refuse("lattice.increment", fmt::format("{}", spec.increment),
           fmt::format("larger: the coarse sweep would have {} designs, and {} are allowed",
                       lattice.designs(), max_designs));
  const std::vector<Design<double>> designs = all_designs(lattice);
  const std::vector<Constraint> constraints = constraints_of(job);
  RankedValues values_of(job, designs.size() * (constraints.empty() ? 1 : 2), style, comm);
  const Eigen::MatrixXd objectives = values_of(designs, {&job.optimum.objective, 1});
  std::vector<Merit> merit;
  for (const double objective : objectives.row(0))
    merit.push_back({objective, std::isfinite(objective) ? 0 : HUGE_VAL});

  CoarseSweep sweep{.increment = designs.size() > 1 ? spec.increment : 0,
                    .designs = designs.size(),
                    .maxima = {},
                    .feasible = false,
                    .checked = 0,
                    .violations = std::vector<std::uint64_t>(constraints.size())};
  std::vector<std::size_t> maxima = local_maxima(lattice, merit);
  if (maxima.empty()) return sweep;
  // If the best design satisfies the constraints, they need not be computed for the others.
  const Design<double>& best = designs[maxima.front()];
  sweep.feasible =
      constraints.empty() ||
      violations_of(constraints, job.scene, {&best, 1}, values_of, sweep.violations).front() <=
          feasibility_tolerance;
  if (!sweep.feasible) {
    std::ranges::fill(sweep.violations, 0);
    for (Merit& m : merit) m.violation = HUGE_VAL;
    sweep.checked = find_violations(job, designs, values_of, merit, sweep.violations);
    maxima = local_maxima(lattice, merit);
    sweep.feasible = !maxima.empty() && is_feasible(merit[maxima.front()]);
    if (sweep.feasible)
      std::erase_if(maxima, [&](std::size_t m) { return !is_feasible(merit[m]); });
  }
  for (const std::size_t m : maxima) sweep.maxima.push_back(designs[m]);
  return sweep;
}

}  // namespace trebsweep
