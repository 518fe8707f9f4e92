#include "trebsweep/sweep/measured_error.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <set>
#include <utility>

#include "trebsweep/base/mpi.hpp"
#include "trebsweep/job/sample.hpp"
#include "trebsweep/sweep/objective.hpp"
#include "trebsweep/swing/integrate.hpp"
#include "trebsweep/swing/reference.hpp"

namespace trebsweep {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// The number of designs spread over a lattice: enough to find the region with the largest errors,
/// and few enough that the check takes less than 2 % of the time of a sweep of 100,000 designs.
std::size_t sample_size(const Lattice& lattice, const Job& job) {
  const std::uint64_t designs = lattice.designs();
  // An elastic sling goes slack in small regions, whose errors are far larger than elsewhere.
  if (job.scene.sling_stiffness > 0) return std::clamp<std::size_t>(designs / 200, 512, 2048);
  // A sweep with a fixed step takes less time, and its errors vary smoothly over the lattice.
  if (!follows_tolerance(job.solver.stepper))
    return std::clamp<std::size_t>(designs / 800, 128, 1024);
  return std::clamp<std::size_t>(designs / 400, 256, 1024);
}

/// A box around an index that extends a fraction of the lattice to each side.
Block box_around(const Index3& centre, double fraction, const Lattice& lattice) {
  Block box{};
  for (std::size_t d = 0; d < 3; ++d) {
    const std::size_t extent = lattice.extent()[d];
    const auto reach =
        std::max<std::size_t>(1, static_cast<std::size_t>(fraction * static_cast<double>(extent)));
    box.first[d] = centre[d] - std::min(centre[d], reach);
    box.count[d] = std::min(centre[d] + reach + 1, extent) - box.first[d];
  }
  return box;
}

/// Integrates designs with the job's solver and accurately.
std::vector<Check> check(const Job& job, std::span<const Design<double>> designs,
                         bool with_objective) {
  constexpr std::array fields{Field::efficiency};
  std::vector<SwingResult> results(designs.size()), accurate(designs.size());
  std::vector<double> efficiencies(designs.size());
  integrate(job.scene, job.solver, {designs, results, fields, efficiencies});
  integrate_accurately(job.scene, checking_solver(job.scene, job.solver), {designs, accurate});
  std::vector<Check> checks;
  for (std::size_t i = 0; i < designs.size(); ++i)
    checks.push_back({designs[i], results[i], accurate[i], efficiencies[i], nan, nan});
  if (!with_objective) return checks;
  // In a separate integration, because a field of the flight changes statuses.
  std::vector<Field> deciding = deciding_fields(job);
  deciding.push_back(Field::slack);
  std::vector<double> values(designs.size() * deciding.size());
  const Batch batch{designs, results, deciding, values};
  integrate(job.scene, job.solver, batch);
  for (std::size_t i = 0; i < designs.size(); ++i) {
    const auto of_design = batch.slice(i, 1).values;
    checks[i].slack = of_design.back();
    checks[i].objective = objective({job.scene, designs[i], deciding, of_design}, job);
  }
  return checks;
}

bool is_begun(const Check& check) { return check.accurate.status != Status::outside_lattice; }

/// Whether a design was integrated accurately, whatever the outcome.
bool is_measured(const Check& check) {
  return is_begun(check) && check.accurate.status != Status::step_budget &&
         check.accurate.status != Status::step_underflow;
}

/// How the work is shared out: in parts of at most `part_size` designs, none of which is begun once
/// `stop` is true.
struct Shares {
  std::size_t part_size;
  std::function<bool()> stop;
  MPI_Comm comm;
};

/// Returns compute(designs), one result per design, computed in parts on all ranks; the results of
/// parts that were not begun are zero. Collective.
template <class F>
auto on_all_ranks(const std::vector<Design<double>>& designs, const Shares& shares, F compute) {
  const auto ranks = static_cast<std::size_t>(mpi::size(shares.comm));
  const std::size_t parts =
      ranks * ((designs.size() + ranks * shares.part_size - 1) / (ranks * shares.part_size));
  decltype(compute(designs)) results(designs.size());
  for (auto p = static_cast<std::size_t>(mpi::rank(shares.comm)); p < parts && !shares.stop();
       p += ranks) {
    std::vector<Design<double>> part;  // every parts-th design, so that each part is representative
    for (std::size_t i = p; i < designs.size(); i += parts) part.push_back(designs[i]);
    const auto computed = compute(part);
    for (std::size_t k = 0; k < computed.size(); ++k) results[p + k * parts] = computed[k];
  }
  mpi::merge(std::span(results), shares.comm);
  return results;
}

/// How much the speed of each design changes with a finer solver, m/s; 0 without a release.
std::vector<double> speed_changes(const Job& job, std::span<const Design<double>> designs) {
  Solver finer = job.solver;
  finer.tolerance = std::max(finer.tolerance / 10, 1e-15);
  finer.time_step /= 2;
  std::vector<SwingResult> coarse(designs.size()), fine(designs.size());
  integrate(job.scene, job.solver, {designs, coarse});
  integrate(job.scene, finer, {designs, fine});
  std::vector<double> changes;
  for (std::size_t i = 0; i < designs.size(); ++i)
    changes.push_back(std::fmax(std::abs(coarse[i].speed - fine[i].speed), 0));  // NaN gives 0
  return changes;
}

/// The `count` indices whose speeds change most with a finer solver, in descending order.
/// Collective.
std::vector<Index3> most_sensitive(const Job& job, const Lattice& lattice,
                                   const std::vector<Index3>& indices, std::size_t count,
                                   const Shares& shares) {
  const auto changes = on_all_ranks(designs_at(indices, lattice), shares,
                                    [&](const auto& part) { return speed_changes(job, part); });
  std::vector<std::pair<double, Index3>> order;
  for (std::size_t i = 0; i < indices.size(); ++i) order.emplace_back(-changes[i], indices[i]);
  std::ranges::stable_sort(order, {}, &std::pair<double, Index3>::first);
  std::vector<Index3> chosen;
  for (std::size_t i = 0; i < std::min(order.size(), count); ++i) chosen.push_back(order[i].second);
  return chosen;
}

/// The indices of the best design and its neighbours, and of a design of each status.
std::vector<Index3> notable_indices(const Study& study, std::uint64_t scene, const Totals& totals) {
  const Lattice& lattice = study.own_lattice(scene);
  std::vector<Index3> indices;
  if (const BestDesign& best = totals.best[scene]; best.exists())
    indices = sample_box(lattice, box_around(lattice.index_of(best.design), 0, lattice), 27);
  for (const std::uint64_t cell : totals.tally.first_cells)
    if (cell != no_cell && study.design(cell).first == scene)
      indices.push_back(lattice.index_of(study.design(cell).second));
  return indices;
}

/// The error of the best design's speed, m/s; NaN if it is not among the checks or has no release.
/// Collective.
double error_at_best(const Job& job, const BestDesign& best, const std::vector<Check>& checks,
                     const std::function<bool()>& stop, MPI_Comm comm) {
  const auto found = std::find_if(checks.begin(), checks.end(),
                                  [&](const Check& c) { return c.design == best.design; });
  if (found == checks.end() || std::isnan(found->error())) return nan;
  // Rounding errors of double precision only matter where the error is small.
  const double tolerance = std::clamp(1e-4 * found->error(), 1e-15, 1e-13);
  double speed = nan;
  if (mpi::rank(comm) == 0 && !stop())
    speed = speed_in_extended_precision(job.scene, best.design, tolerance, job.solver);
  speed = mpi::from_root(speed, comm);
  return std::isnan(speed) ? found->error() : std::abs(best.speed - speed);
}

/// Checks designs of a scene; collective. Returns nothing once `stop` is true on any rank.
std::optional<ErrorSample> check_scene(const Study& study, std::uint64_t scene,
                                       const Totals& totals, double seconds,
                                       const std::function<bool()>& stop, MPI_Comm comm) {
  const Job job = job_at(study.job(), scene);
  const Lattice& lattice = study.own_lattice(scene);
  const double deadline = MPI_Wtime() + seconds;
  const auto stop_or_late = [&] { return stop() || MPI_Wtime() > deadline; };
  const double seconds_per_design =
      totals.tally.integration_seconds /
      static_cast<double>(std::max<std::uint64_t>(1, totals.tally.designs()));
  const auto part_size =
      static_cast<std::size_t>(std::clamp(0.01 / seconds_per_design, 16.0, 512.0));
  const Shares hurried{part_size, stop_or_late, comm}, patient{part_size, stop, comm};
  ErrorSample sample;
  sample.scene = scene;
  std::set<Index3> checked;
  const auto add = [&](const std::vector<Index3>& indices, bool with_objective,
                       const Shares& shares) {
    std::set<Index3> left(indices.begin(), indices.end());
    std::erase_if(left, [&](const Index3& index) { return checked.contains(index); });
    const auto designs = designs_at(std::vector(left.begin(), left.end()), lattice);
    const auto checks = on_all_ranks(
        designs, shares, [&](const auto& part) { return check(job, part, with_objective); });
    for (const Check& c : checks) {
      if (is_begun(c)) checked.insert(lattice.index_of(c.design));
      if (is_measured(c)) sample.checks.push_back(c);
    }
  };
  // Notable designs are few: measured however long they take.
  add(notable_indices(study, scene, totals), true, patient);
  const std::size_t spread = sample_size(lattice, job);
  const auto sampled = sample_indices(lattice, spread);
  add(sampled, false, hurried);
  const std::set<Index3> is_spread(sampled.begin(), sampled.end());
  for (Check& c : sample.checks) c.spread = is_spread.contains(lattice.index_of(c.design));
  // Where an elastic sling goes slack, single designs have errors far larger than their neighbours.
  const std::size_t searched = job.scene.sling_stiffness > 0 ? 16384 : spread / 4;
  for (const double fraction : {1.0 / 8, 1.0 / 16}) {
    // fmax(NaN, x) is x.
    const auto worst = std::max_element(sample.checks.begin(), sample.checks.end(),
                                        [](const Check& a, const Check& b) {
                                          return std::fmax(a.error(), 0) < std::fmax(b.error(), 0);
                                        });
    if (worst == sample.checks.end()) break;
    const Block box = box_around(lattice.index_of(worst->design), fraction, lattice);
    std::vector<Index3> candidates = sample_box(lattice, box, searched);
    std::erase_if(candidates, [&](const Index3& index) { return checked.contains(index); });
    add(most_sensitive(job, lattice, candidates, 16, hurried), false, hurried);
  }
  if (const BestDesign& best = totals.best[scene]; best.exists())
    sample.at_best = error_at_best(job, best, sample.checks, stop, comm);
  if (mpi::max(stop() ? 1 : 0, comm) > 0) return std::nullopt;
  return sample;
}

/// The scenes in which the error is measured, in ascending order.
std::set<std::uint64_t> scenes_to_check(const Study& study, const Totals& totals) {
  constexpr std::uint64_t spread = 8;
  std::set<std::uint64_t> scenes;
  if (const auto best = best_scene(totals.best)) scenes.insert(*best);
  if (const auto best = totals.summary().best()) scenes.insert(*best);
  for (const std::uint64_t cell : totals.tally.first_cells)
    if (cell != no_cell) scenes.insert(study.design(cell).first);
  for (std::uint64_t n = 0; n < spread; ++n) scenes.insert(n * (study.scenes() - 1) / (spread - 1));
  return scenes;
}

}  // namespace

std::optional<std::vector<ErrorSample>> check_scenes(const Study& study, const Totals& totals,
                                                     const std::function<bool()>& stop,
                                                     MPI_Comm comm) {
  const auto scenes = scenes_to_check(study, totals);
  const double seconds =
      std::max(1.0, 0.01 * totals.tally.sweep_seconds / static_cast<double>(scenes.size()));
  std::vector<ErrorSample> samples;
  for (const std::uint64_t scene : scenes) {
    auto sample = check_scene(study, scene, totals, seconds, stop, comm);
    if (!sample) return std::nullopt;
    samples.push_back(std::move(*sample));
  }
  return samples;
}

std::optional<MeasuredError> measured_error(std::span<const ErrorSample> samples,
                                            std::uint64_t scene) {
  std::vector<double> spread;
  MeasuredError error{nan, nan, nan, 0};
  for (const ErrorSample& sample : samples) {
    for (const Check& c : sample.checks) {
      if (std::isnan(c.error())) continue;
      if (c.spread) spread.push_back(c.error());
      error.largest = std::fmax(error.largest, c.error());  // fmax(NaN, x) is x
      ++error.designs;
    }
    error.largest = std::fmax(error.largest, sample.at_best);
    if (sample.scene == scene) error.at_optimum = sample.at_best;
  }
  if (error.designs == 0) return std::nullopt;
  std::ranges::sort(spread);
  if (!spread.empty()) error.median = spread[spread.size() / 2];
  return error;
}

}  // namespace trebsweep
