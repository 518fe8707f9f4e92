#include "trebsweep/sweep/measured_error.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <set>

#include "trebsweep/base/mpi.hpp"
#include "trebsweep/job/sample.hpp"
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
    return std::clamp<std::size_t>(designs / 640, 160, 1024);
  return std::clamp<std::size_t>(designs / 400, 256, 1024);
}

/// A box around an index that extends a fraction of the lattice to each side.
Tile box_around(const Index3& centre, double fraction, const Lattice& lattice) {
  Tile box{};
  for (std::size_t d = 0; d < 3; ++d) {
    const std::size_t extent = lattice.extent()[d];
    const auto reach =
        std::max<std::size_t>(1, static_cast<std::size_t>(fraction * static_cast<double>(extent)));
    box.first[d] = centre[d] - std::min(centre[d], reach);
    box.count[d] = std::min(centre[d] + reach + 1, extent) - box.first[d];
  }
  return box;
}

/// Integrates designs with the job's solver and accurately. The field slack takes long.
std::vector<Check> check(const Job& job, std::span<const Design<double>> designs, bool with_slack) {
  std::vector<Field> fields{Field::efficiency};
  if (with_slack) fields.push_back(Field::slack);
  std::vector<SwingResult> results(designs.size()), accurate(designs.size());
  std::vector<double> values(designs.size() * fields.size());
  integrate(job.scene, job.solver, {designs, results, fields, values});
  integrate_accurately(job.scene, job.solver, designs, accurate);
  std::vector<Check> checks;
  for (std::size_t i = 0; i < designs.size(); ++i)
    checks.push_back({.design = designs[i],
                      .speed = results[i].speed,
                      .efficiency = values[i * fields.size()],
                      .accurate_speed = accurate[i].speed,
                      .slack = with_slack ? values[i * fields.size() + 1] : nan,
                      .status = results[i].status,
                      .accurate_status = accurate[i].status});
  return checks;
}

bool is_begun(const Check& check) { return check.accurate_status != Status::outside_lattice; }

/// Whether a design was integrated accurately, whatever the outcome.
bool is_measured(const Check& check) {
  return is_begun(check) && check.accurate_status != Status::step_budget &&
         check.accurate_status != Status::step_underflow;
}

/// Checks designs on all ranks, in parts of at most `part_size`; the designs of parts that are not
/// begun once `stop` is true have the status outside_lattice. Collective.
std::vector<Check> check_on_all_ranks(const Job& job, const std::vector<Design<double>>& designs,
                                      bool with_slack, std::size_t part_size,
                                      const std::function<bool()>& stop, MPI_Comm comm) {
  const auto ranks = static_cast<std::size_t>(mpi::size(comm));
  const std::size_t parts =
      ranks * ((designs.size() + ranks * part_size - 1) / (ranks * part_size));
  std::vector<Check> checks(designs.size());
  for (auto p = static_cast<std::size_t>(mpi::rank(comm)); p < parts && !stop(); p += ranks) {
    std::vector<Design<double>> part;  // every parts-th design, so that each part is representative
    for (std::size_t i = p; i < designs.size(); i += parts) part.push_back(designs[i]);
    const auto checked = check(job, part, with_slack);
    for (std::size_t k = 0; k < checked.size(); ++k) checks[p + k * parts] = checked[k];
  }
  mpi::merge(std::span(checks), comm);
  return checks;
}

/// The indices of the optimum and its neighbours, and of a design of each status.
std::vector<Index3> notable_indices(const Summary& summary, const Lattice& lattice) {
  std::vector<Index3> indices;
  if (summary.optimum)
    indices =
        sample_box(lattice, box_around(lattice.index_of(summary.optimum->design), 0, lattice), 27);
  for (const auto& design : summary.first_of_statuses) indices.push_back(lattice.index_of(design));
  return indices;
}

/// The errors of the checks with a speed, sorted.
std::vector<double> sorted_errors(const std::vector<Check>& checks) {
  std::vector<double> errors;
  for (const Check& c : checks)
    if (!std::isnan(c.error())) errors.push_back(c.error());
  std::sort(errors.begin(), errors.end());
  return errors;
}

/// The error of the optimum's speed, m/s; NaN if it is not among the checks or has no release.
/// Collective.
double error_at_optimum(const Job& job, const Optimum& optimum, const std::vector<Check>& checks,
                        const std::function<bool()>& stop, MPI_Comm comm) {
  const auto found = std::find_if(checks.begin(), checks.end(),
                                  [&](const Check& c) { return c.design == optimum.design; });
  if (found == checks.end() || std::isnan(found->error())) return nan;
  // Rounding errors of double precision only matter where the error is small.
  const double tolerance = std::clamp(1e-4 * found->error(), 1e-15, 1e-13);
  double speed = nan;
  if (mpi::rank(comm) == 0 && !stop())
    speed = speed_in_extended_precision(job.scene, optimum.design, tolerance, job.solver);
  speed = mpi::from_root(speed, comm);
  return std::isnan(speed) ? found->error() : std::abs(optimum.speed - speed);
}

}  // namespace

std::optional<ErrorSample> measure_error(const Job& job, const Lattice& lattice,
                                         const Summary& summary, const std::function<bool()>& stop,
                                         MPI_Comm comm) {
  const double deadline = MPI_Wtime() + std::max(1.0, 0.01 * summary.sweep_seconds);
  const auto stop_or_late = [&] { return stop() || MPI_Wtime() > deadline; };
  const double seconds_per_design =
      summary.integration_seconds /
      static_cast<double>(std::max<std::uint64_t>(1, summary.designs()));
  const auto part_size =
      static_cast<std::size_t>(std::clamp(0.01 / seconds_per_design, 16.0, 512.0));
  ErrorSample sample;
  std::set<Index3> checked;
  const auto add = [&](const std::vector<Index3>& indices, bool with_slack,
                       const std::function<bool()>& end) {
    std::set<Index3> left(indices.begin(), indices.end());
    std::erase_if(left, [&](const Index3& index) { return checked.contains(index); });
    std::vector<Design<double>> designs;
    for (const Index3& index : left) designs.push_back(lattice.design(index));
    for (const Check& c : check_on_all_ranks(job, designs, with_slack, part_size, end, comm)) {
      if (is_begun(c)) checked.insert(lattice.index_of(c.design));
      if (is_measured(c)) sample.checks.push_back(c);
    }
  };
  const std::size_t spread = sample_size(lattice, job);
  add(sample_indices(lattice, spread), false, stop_or_late);
  const std::vector<double> even = sorted_errors(sample.checks);
  add(notable_indices(summary, lattice), true, stop);  // few: measured however long they take
  for (const double fraction : {1.0 / 8, 1.0 / 16}) {
    // fmax(NaN, x) is x.
    const auto worst = std::max_element(sample.checks.begin(), sample.checks.end(),
                                        [](const Check& a, const Check& b) {
                                          return std::fmax(a.error(), 0) < std::fmax(b.error(), 0);
                                        });
    if (worst == sample.checks.end()) break;
    const Tile box = box_around(lattice.index_of(worst->design), fraction, lattice);
    add(sample_box(lattice, box, spread / 4), false, stop_or_late);
  }
  const double at_optimum =
      summary.optimum ? error_at_optimum(job, *summary.optimum, sample.checks, stop, comm) : nan;
  if (mpi::max(stop() ? 1 : 0, comm) > 0) return std::nullopt;
  if (const std::vector<double> all = sorted_errors(sample.checks); !all.empty())
    sample.error = {.median = even.empty() ? nan : even[even.size() / 2],
                    .largest = std::fmax(all.back(), at_optimum),
                    .at_optimum = at_optimum,
                    .designs = all.size()};
  return sample;
}

}  // namespace trebsweep
