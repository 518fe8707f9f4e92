#include "trebsweep/sweep/warnings.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "trebsweep/ode/stepper_info.hpp"

namespace trebsweep {
namespace {

std::string text_of(const Design<double>& d) {
  return fmt::format("r1 = {}, r2 = {}, r3 = {} m", d.r1, d.r2, d.r3);
}

/// The bounds that a design of the lattice touches, as "r1 = 0.51 m, the smallest allowed by h - h0
/// < r1 (47)". An axis with a single value has none.
std::vector<std::string> bounds_at(const Design<double>& design, const Job& job,
                                   const Lattice& lattice) {
  const Index3 index = lattice.index_of(design);
  struct Axis {
    const char* name;
    const std::optional<AxisRange>& range;  ///< from the job
    std::string lower, upper;               ///< bounds of an axis without a range
    std::size_t count;
  };
  const LatticeSpec& spec = job.lattice;
  const ArmBounds r1 = arm_bounds(job.scene);
  const std::array<Axis, 3> axes{
      {{"r1", spec.r1, r1.low_text + " < r1 (47)", "r1 < " + r1.high_text + " (47)",
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

/// The largest speed of the optimum and the checked designs, m/s; 0 without a release.
double largest_speed(const std::optional<Optimum>& optimum, std::span<const Check> checks) {
  double largest = optimum ? optimum->speed : 0;
  for (const Check& c : checks) largest = std::fmax(largest, c.speed);  // fmax(x, NaN) is x
  return largest;
}

std::string efficiency_warning(std::span<const Check> checks, double largest_speed) {
  constexpr double rounding = 1e-6;
  // The efficiency of a design that hardly moves is a quotient of rounding errors.
  constexpr double moving = 1e-3;
  const auto is_impossible = [&](const Check& c) {
    return c.efficiency > 1 + rounding && c.speed > moving * largest_speed;
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

/// How to integrate more accurately.
std::string advice(const Solver& solver) {
  return follows_tolerance(solver.stepper)
             ? "reduce solver.tolerance"
             : "reduce solver.time-step, or choose an adaptive stepper";
}

std::string status_warning(std::span<const Check> checks, const Solver& solver) {
  const auto differs = [](const Check& c) { return c.status != c.accurate_status; };
  const auto first = std::find_if(checks.begin(), checks.end(), differs);
  if (first == checks.end()) return "";
  return fmt::format(
      "a different status when integrated accurately in {} of {} designs checked, such as {}: {} "
      "instead of {}; {}",
      std::count_if(checks.begin(), checks.end(), differs), checks.size(), text_of(first->design),
      name_of(first->accurate_status), name_of(first->status),
      first->status == Status::step_budget ? "increase solver.max-steps" : advice(solver));
}

std::string speed_warning(const MeasuredError& error, double largest_speed, const Solver& solver) {
  constexpr double noticeable = 0.01;
  if (!(error.largest > noticeable * largest_speed)) return "";
  const bool adaptive = follows_tolerance(solver.stepper);
  const std::string at_optimum =
      std::isnan(error.at_optimum)
          ? ""
          : fmt::format(", and by {:.2g} m/s at the optimum", error.at_optimum);
  return fmt::format("the {}: among {} designs checked the speed is off by up to {:.2g} m/s{}; {}",
                     adaptive ? "tolerance is loose" : "fixed step is long", error.designs,
                     error.largest, at_optimum, advice(solver));
}

std::string slack_warning(std::span<const Check> checks, double best_value, Field objective) {
  const double near = best_value - 0.05 * std::abs(best_value);
  const auto is_best = [&](const Check& c) { return c.objective >= near && !std::isnan(c.slack); };
  const auto slack = std::count_if(checks.begin(), checks.end(),
                                   [&](const Check& c) { return is_best(c) && c.slack == 2; });
  if (slack == 0) return "";
  return fmt::format(
      "a sling that would go slack before the release in {} of {} designs checked within 5 % of "
      "the optimum's {}, where the model's rigid sling pushes; the field slack marks such "
      "designs, output.optimum = taut excludes them",
      slack, std::count_if(checks.begin(), checks.end(), is_best), info(objective).name);
}

/// The edges of a lattice that a design may lie on.
constexpr std::array edge_names{"the smallest r1", "the largest r1",  "the smallest r3",
                                "the largest r3",  "the smallest r2", "the largest r2"};

/// Which of these edges the design at an index lies on. An axis with a single value has none.
std::array<bool, 6> edges_at(const Lattice& lattice, const Index3& index) {
  const auto& [i1, i3, i2] = index;
  const auto& r1 = lattice.r1_indices();
  const bool first_r1 = i1 == r1.front(), last_r1 = i1 == r1.back();
  const bool last_row = i3 + 1 == lattice.extent()[1] || lattice.row_length(i3 + 1) == 0;
  const bool last_r2 = i2 + 1 == lattice.row_length(i3);
  return {first_r1 && !last_r1, last_r1 && !first_r1, i3 == 0 && !last_row,
          last_row && i3 != 0,  i2 == 0 && !last_r2,  last_r2 && i2 != 0};
}

/// In how many scenes the optimum of the lattice lies on which edge; empty if on none.
std::string edges_text(const Study& study, std::span<const Tally> tallies) {
  std::array<std::uint64_t, edge_names.size()> counts{};
  std::uint64_t scenes = 0;
  for (std::uint64_t scene = 0; scene < tallies.size(); ++scene) {
    const std::uint64_t cell = tallies[scene].best_cell;
    if (cell == no_cell) continue;
    const Lattice& lattice = study.lattice(scene);
    const auto edges = edges_at(lattice, lattice.index_of(study.design(cell).second));
    for (std::size_t e = 0; e < edges.size(); ++e) counts[e] += edges[e];
    scenes += std::ranges::count(edges, true) > 0;
  }
  if (scenes == 0) return "";
  std::vector<std::string> parts;
  for (std::size_t e = 0; e < counts.size(); ++e)
    if (counts[e] > 0) parts.push_back(fmt::format("{} in {}", edge_names[e], counts[e]));
  return fmt::format("the optimum of {} of {} scenes lies on the edge of the lattice: {}", scenes,
                     study.scenes(), fmt::join(parts, ", "));
}

}  // namespace

std::vector<std::string> warnings(const Job& job, const Lattice& lattice,
                                  const std::optional<Optimum>& optimum,
                                  const std::optional<MeasuredError>& error,
                                  std::span<const Check> checks) {
  std::vector<std::string> lines;
  const auto add = [&](const std::string& line) {
    if (!line.empty()) lines.push_back(line);
  };
  if (optimum && !job.optimum.refine)  // else the search goes beyond the edge
    if (const auto bounds = bounds_at(optimum->design, job, lattice); !bounds.empty())
      add(fmt::format("the optimum lies on the edge of the lattice: {}", fmt::join(bounds, "; ")));
  add(status_warning(checks, job.solver));
  const double largest = largest_speed(optimum, checks);
  add(efficiency_warning(checks, largest));
  if (error) add(speed_warning(*error, largest, job.solver));
  if (optimum && job.output.optimum_filter == OptimumFilter::all && job.scene.sling_stiffness == 0)
    add(slack_warning(checks, optimum->value, job.optimum.objective));
  return lines;
}

std::vector<std::string> warnings(const Study& study, const Summary& summary,
                                  std::span<const Tally> tallies,
                                  std::span<const ErrorSample> samples) {
  const Job& job = study.job();
  const std::uint64_t best = summary.optimum ? summary.optimum->scene : 0;
  const auto sample = std::ranges::find(samples, best, &ErrorSample::scene);
  const std::span<const Check> checks =
      sample == samples.end() ? std::span<const Check>() : std::span(sample->checks);
  std::vector<std::string> lines =
      warnings(job_at(job, best), study.own_lattice(best), summary.optimum, summary.error, checks);
  if (!is_study(job)) return lines;

  for (std::string& line : lines)
    line = fmt::format("the best scene, {}: {}", outer_values_text(job, best), line);
  std::string example;
  std::uint64_t scenes = 0;
  for (const ErrorSample& other : samples) {
    if (other.scene == best) continue;
    const auto of_scene =
        warnings(job_at(job, other.scene), study.own_lattice(other.scene), std::nullopt,
                 measured_error({&other, 1}, other.scene), other.checks);
    if (of_scene.empty()) continue;
    ++scenes;
    example = fmt::format("{}: {}", outer_values_text(job, other.scene), of_scene.front());
  }
  if (scenes > 0)
    lines.push_back(fmt::format("{} of {} other scenes checked have warnings, such as that with {}",
                                scenes, samples.size() - 1, example));
  if (const std::string edges = edges_text(study, tallies); !edges.empty() && !job.optimum.refine)
    lines.push_back(edges);
  return lines;
}

}  // namespace trebsweep
