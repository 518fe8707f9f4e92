#include "trebsweep/sweep/warnings.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "trebsweep/base/mpi.hpp"
#include "trebsweep/job/sample.hpp"
#include "trebsweep/ode/stepper_info.hpp"
#include "trebsweep/swing/integrate.hpp"

namespace trebsweep {
namespace {

/// A design that was integrated again.
struct Check {
  Design<double> design;
  double speed, efficiency, accurate_speed;
  bool slack;
  Status status, accurate_status;
};

std::string text_of(const Design<double>& d) {
  return fmt::format("r1 = {}, r2 = {}, r3 = {} m", d.r1, d.r2, d.r3);
}

Index3 index_of(const Design<double>& design, const Lattice& lattice) {
  const auto index_along = [&](std::size_t axis, double value) {
    const auto& values = lattice.axes()[axis];
    return static_cast<std::size_t>(std::lower_bound(values.begin(), values.end(), value) -
                                    values.begin());
  };
  return {index_along(0, design.r1), index_along(1, design.r3), index_along(2, design.r2)};
}

/// The design at an index and its neighbours: up to 27 designs.
std::vector<Design<double>> neighbourhood(const Index3& centre, const Lattice& lattice) {
  const Index3 extent = lattice.extent();
  std::array<std::vector<std::size_t>, 3> near;
  for (std::size_t d = 0; d < 3; ++d)
    for (std::size_t i = centre[d] - std::min<std::size_t>(centre[d], 1);
         i < std::min(centre[d] + 2, extent[d]); ++i)
      near[d].push_back(i);
  std::vector<Design<double>> designs;
  for (const std::size_t i1 : near[0])
    for (const std::size_t i3 : near[1])
      for (const std::size_t i2 : near[2])
        if (lattice.holds({i1, i3, i2})) designs.push_back(lattice.design({i1, i3, i2}));
  return designs;
}

/// Integrates designs with the job's solver and, if that has a fixed step, accurately.
std::vector<Check> check(const Job& job, std::span<const Design<double>> designs) {
  const std::array fields{Field::efficiency, Field::slack};
  std::vector<SwingResult> results(designs.size()), accurate_results(designs.size());
  std::vector<double> values(designs.size() * fields.size());
  integrate(job.scene, job.solver, {designs, results, fields, values});
  if (follows_tolerance(job.solver.stepper))
    accurate_results = results;
  else
    integrate(job.scene, accurate(job.solver), {designs, accurate_results});
  std::vector<Check> checks;
  for (std::size_t i = 0; i < designs.size(); ++i)
    checks.push_back({.design = designs[i],
                      .speed = results[i].speed,
                      .efficiency = values[2 * i],
                      .accurate_speed = accurate_results[i].speed,
                      .slack = values[2 * i + 1] == 2,
                      .status = results[i].status,
                      .accurate_status = accurate_results[i].status});
  return checks;
}

/// Checks designs on all ranks; leaves out those that are not started within a second, or once
/// `stop` is true. Collective.
std::vector<Check> check_within_a_second(const Job& job, const std::vector<Design<double>>& designs,
                                         const std::function<bool()>& stop, MPI_Comm comm) {
  constexpr std::size_t part_size = 16;  // fills the lanes
  struct Part {
    std::array<Check, part_size> checks;
    std::size_t count;
  };
  const std::size_t part_count = (designs.size() + part_size - 1) / part_size;
  const double start = MPI_Wtime();
  const auto parts = mpi::share(part_count, comm, [&](std::size_t p) {
    Part part{};
    if (stop() || MPI_Wtime() - start > 1) return part;
    const std::size_t first = p * part_size;
    part.count = std::min(part_size, designs.size() - first);
    const auto checks = check(job, std::span(designs).subspan(first, part.count));
    std::copy(checks.begin(), checks.end(), part.checks.begin());
    return part;
  });
  std::vector<Check> checks;
  for (const Part& part : parts)
    checks.insert(checks.end(), part.checks.begin(),
                  part.checks.begin() + static_cast<std::ptrdiff_t>(part.count));
  return checks;
}

/// The bounds that the design at an index touches, as "r1 = 0.51 m, the smallest allowed by h - h0
/// < r1 (47)". An axis with a single value has none.
std::vector<std::string> bounds_at(const Index3& index, const Job& job, const Lattice& lattice) {
  struct Axis {
    const char* name;
    const std::optional<AxisRange>& range;  ///< from the job
    const char *lower, *upper;              ///< bounds of an axis without a range
    std::size_t count;
  };
  const LatticeSpec& spec = job.lattice;
  const bool is_raised = job.scene.release_height > job.scene.fulcrum_height;
  const std::array<Axis, 3> axes{
      {{"r1", spec.r1, is_raised ? "h - h0 < r1 (47)" : "0 < r1", "r1 < h0 (47)",
        lattice.extent()[0]},
       {"r3", spec.r3, "lattice.shortest-sling", "r3 < h0 (48)", lattice.extent()[1]},
       {"r2", spec.r2, "0 < r2 (49)", "r2 < h0 - r3 (49)", lattice.row_length(index[1])}}};
  std::vector<std::string> bounds;
  for (std::size_t d = 0; d < 3; ++d) {
    const Axis& axis = axes[d];
    const bool largest = index[d] + 1 == axis.count;
    if (lattice.extent()[d] == 1 || (index[d] > 0 && !largest)) continue;
    bounds.push_back(fmt::format(
        "{} = {} m, the {} allowed by {}", axis.name, lattice.axes()[d][index[d]],
        largest ? "largest" : "smallest",
        axis.range ? fmt::format("lattice.{}", axis.name) : (largest ? axis.upper : axis.lower)));
  }
  return bounds;
}

std::string efficiency_warning(const std::vector<Check>& checks, double best_speed) {
  constexpr double rounding = 1e-6;
  // The efficiency of a design that hardly moves is a quotient of rounding errors.
  constexpr double moving = 1e-3;
  const auto is_impossible = [&](const Check& c) {
    return c.efficiency > 1 + rounding && c.speed > moving * best_speed;
  };
  const auto count = std::count_if(checks.begin(), checks.end(), is_impossible);
  if (count == 0) return "";
  const auto most =
      std::max_element(checks.begin(), checks.end(), [&](const Check& a, const Check& b) {
        return (is_impossible(a) ? a.efficiency : 0) < (is_impossible(b) ? b.efficiency : 0);
      });
  return fmt::format(
      "an energy efficiency above 1 in {} of {} designs checked, up to {:.4g} at {}: the solver "
      "creates energy; reduce its time step or tolerance",
      count, checks.size(), most->efficiency, text_of(most->design));
}

std::string status_warning(const std::vector<Check>& checks, const Solver& solver) {
  const auto differs = [](const Check& c) { return c.status != c.accurate_status; };
  const auto first = std::find_if(checks.begin(), checks.end(), differs);
  if (first == checks.end()) return "";
  return fmt::format(
      "a different status when integrated accurately in {} of {} designs checked, such as {}: {} "
      "instead of {}; reduce solver.time-step, or choose an adaptive stepper instead of {}",
      std::count_if(checks.begin(), checks.end(), differs), checks.size(), text_of(first->design),
      name_of(first->accurate_status), name_of(first->status), solver.stepper);
}

std::string speed_warning(const std::vector<Check>& checks, const Optimum& optimum) {
  constexpr double noticeable = 0.01;
  double largest = 0, at_optimum = 0;
  for (const Check& c : checks) {
    const double error = std::abs(c.speed - c.accurate_speed);  // NaN if either has no release
    if (error > largest) largest = error;
    if (c.design == optimum.design) at_optimum = error;
  }
  if (!(largest > noticeable * optimum.speed)) return "";
  return fmt::format(
      "the fixed step is long: among {} designs checked the speed is off by up to {:.2g} m/s, and "
      "by {:.2g} m/s at the optimum; reduce solver.time-step, or choose an adaptive stepper",
      checks.size(), largest, at_optimum);
}

std::string slack_warning(const std::vector<Check>& checks, double best_speed) {
  constexpr double near = 0.95;
  const auto is_best = [&](const Check& c) { return c.speed >= near * best_speed; };
  const auto slack = std::count_if(checks.begin(), checks.end(),
                                   [&](const Check& c) { return is_best(c) && c.slack; });
  if (slack == 0) return "";
  return fmt::format(
      "a sling that would go slack before the release in {} of {} designs checked within 5 % of "
      "the optimum's speed, where the model's rigid sling pushes; the field slack marks such "
      "designs, output.optimum = taut excludes them",
      slack, std::count_if(checks.begin(), checks.end(), is_best));
}

}  // namespace

std::vector<std::string> warnings(const Job& job, const Lattice& lattice, const Summary& summary,
                                  const std::function<bool()>& stop, MPI_Comm comm) {
  std::vector<std::string> lines;
  const auto add = [&](const std::string& line) {
    if (!line.empty()) lines.push_back(line);
  };
  std::vector<Design<double>> designs;
  if (summary.optimum) {
    const Index3 index = index_of(summary.optimum->design, lattice);
    designs = neighbourhood(index, lattice);
    if (const auto bounds = bounds_at(index, job, lattice); !bounds.empty())
      add(fmt::format("the optimum lies on the edge of the lattice: {}", fmt::join(bounds, "; ")));
  }
  for (const auto& design : sample(lattice, 128))
    if (std::find(designs.begin(), designs.end(), design) == designs.end())
      designs.push_back(design);
  const auto checks = check_within_a_second(job, designs, stop, comm);
  add(status_warning(checks, job.solver));
  if (!summary.optimum) return lines;
  add(efficiency_warning(checks, summary.optimum->speed));
  add(speed_warning(checks, *summary.optimum));
  if (job.output.optimum_filter == OptimumFilter::all && job.scene.sling_stiffness == 0)
    add(slack_warning(checks, summary.optimum->speed));
  return lines;
}

}  // namespace trebsweep
