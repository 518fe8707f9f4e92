#include "trebsweep/cli/warnings.hpp"

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

/// The edges that a design may lie on: the ends of r1, r3 and r2.
constexpr std::array edge_names{"the smallest r1", "the largest r1",  "the smallest r3",
                                "the largest r3",  "the smallest r2", "the largest r2"};
using Edges = std::array<bool, edge_names.size()>;

/// Which edges of a lattice one of its designs lies on. An axis with a single value has none.
Edges edges_of_lattice(const Lattice& lattice, const Design<double>& design) {
  const auto [i1, i3, i2] = lattice.index_of(design);
  const auto& r1 = lattice.r1_indices();
  const bool first_r1 = i1 == r1.front(), last_r1 = i1 == r1.back();
  const bool last_row = i3 + 1 == lattice.extent()[1] || lattice.row_length(i3 + 1) == 0;
  const bool last_r2 = i2 + 1 == lattice.row_length(i3);
  return {first_r1 && !last_r1, last_r1 && !first_r1, i3 == 0 && !last_row,
          last_row && i3 != 0,  i2 == 0 && !last_r2,  last_r2 && i2 != 0};
}

/// Which edges a design between those of a lattice lies on: of what the job sets. An optimum on the
/// other bounds is as good as they allow.
Edges edges_of_axes(const LatticeSpec& spec, const Design<double>& design) {
  constexpr double rounding = 1e-6;
  Edges edges{};
  const auto check = [&](std::size_t axis, const std::optional<AxisRange>& range, double length) {
    if (!range || range->first == range->last) return;
    const double almost = rounding * (range->last - range->first);
    edges[2 * axis] = length <= range->first + almost;
    edges[2 * axis + 1] = length >= range->last - almost;
  };
  check(0, spec.r1, design.r1);
  check(1, spec.r3, design.r3);
  check(2, spec.r2, design.r2);
  if (!spec.r3) edges[2] = design.r3 <= spec.shortest_sling * (1 + rounding);
  return edges;
}

/// Which edges the optimum of a scene lies on.
Edges edges_of(const Study& study, std::uint64_t scene, const BestDesign& best) {
  if (!best.exists()) return {};
  const Job& job = study.job();
  return job.optimum.refine ? edges_of_axes(job.lattice, best.design)
                            : edges_of_lattice(study.lattice(scene), best.design);
}

/// The edges with the keys or bounds that set them: "r1 = 0.51 m, the smallest allowed by h - h0 <
/// r1 (47)".
std::string edge_warning(const Job& job, const Design<double>& design, const Edges& edges) {
  struct Axis {
    const char* name;
    double length;
    const std::optional<AxisRange>& range;   ///< from the job
    std::array<std::string, 2> lower_upper;  ///< bounds of an axis without a range
  };
  const LatticeSpec& spec = job.lattice;
  const ArmBounds r1 = arm_bounds(job.scene);
  const std::array<Axis, 3> axes{
      {{"r1", design.r1, spec.r1, {r1.low_text + " < r1 (47)", "r1 < " + r1.high_text + " (47)"}},
       {"r3", design.r3, spec.r3, {"lattice.shortest-sling", "r3 < h0 (48)"}},
       {"r2", design.r2, spec.r2, {"0 < r2 (49)", "r2 < h0 - r3 (49)"}}}};
  std::vector<std::string> bounds;
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const auto& [name, length, range, lower_upper] = axes[e / 2];
    if (edges[e])
      bounds.push_back(fmt::format("{} = {:.9g} m, the {} allowed by {}", name, length,
                                   e % 2 == 0 ? "smallest" : "largest",
                                   range ? fmt::format("lattice.{}", name) : lower_upper[e % 2]));
  }
  if (bounds.empty()) return "";
  return fmt::format("the optimum lies on the edge of the lattice: {}", fmt::join(bounds, "; "));
}

/// Adds a line, unless it is empty.
void add(std::vector<std::string>& lines, const std::string& line) {
  if (!line.empty()) lines.push_back(line);
}

/// The largest speed of the optimum and the checked designs, m/s; 0 without a release.
double largest_speed(const BestDesign& optimum, std::span<const Check> checks) {
  double largest = optimum.exists() ? optimum.speed : 0;
  for (const Check& c : checks) largest = std::fmax(largest, c.result.speed);  // fmax(x, NaN) is x
  return largest;
}

std::string efficiency_warning(std::span<const Check> checks, double largest_speed) {
  constexpr double rounding = 1e-6;
  // The efficiency of a design that hardly moves is a quotient of rounding errors.
  constexpr double moving = 1e-3;
  const auto is_impossible = [&](const Check& c) {
    return c.efficiency > 1 + rounding && c.result.speed > moving * largest_speed;
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
  const auto differs = [](const Check& c) { return c.result.status != c.accurate.status; };
  const auto first = std::find_if(checks.begin(), checks.end(), differs);
  if (first == checks.end()) return "";
  return fmt::format(
      "a different status when integrated accurately in {} of {} designs checked, such as {}: {} "
      "instead of {}; {}",
      std::count_if(checks.begin(), checks.end(), differs), checks.size(), text_of(first->design),
      name_of(first->accurate.status), name_of(first->result.status),
      first->result.status == Status::step_budget ? "increase solver.max-steps" : advice(solver));
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

std::string slack_warning(std::span<const Check> checks, double best_value,
                          const std::string& objective) {
  const double near = best_value - 0.05 * std::abs(best_value);
  const auto is_best = [&](const Check& c) { return c.objective >= near && !std::isnan(c.slack); };
  const auto slack = std::count_if(checks.begin(), checks.end(),
                                   [&](const Check& c) { return is_best(c) && c.slack == 2; });
  if (slack == 0) return "";
  return fmt::format(
      "a sling that would go slack before the release in {} of {} designs checked within 5 % of "
      "the optimum's {}, where the model's rigid sling pushes; the field slack marks such "
      "designs, output.optimum = taut excludes them",
      slack, std::count_if(checks.begin(), checks.end(), is_best), objective);
}

/// "A in 3, B in 2": the names with counts above 0.
template <std::size_t N>
std::string counts_text(const std::array<const char*, N>& names,
                        const std::array<std::uint64_t, N>& counts) {
  std::vector<std::string> parts;
  for (std::size_t i = 0; i < N; ++i)
    if (counts[i] > 0) parts.push_back(fmt::format("{} in {}", names[i], counts[i]));
  return fmt::format("{}", fmt::join(parts, ", "));
}

/// In how many scenes of a study the optimum lies on which edge; empty if on none.
std::string edges_text(const Study& study, std::span<const BestDesign> best) {
  std::array<std::uint64_t, edge_names.size()> counts{};
  std::uint64_t scenes = 0;
  for (std::uint64_t scene = 0; scene < best.size(); ++scene) {
    const Edges edges = edges_of(study, scene, best[scene]);
    for (std::size_t e = 0; e < edges.size(); ++e) counts[e] += edges[e];
    scenes += std::ranges::count(edges, true) > 0;
  }
  if (scenes == 0) return "";
  return fmt::format("the optimum of {} of {} scenes lies on the edge of the lattice: {}", scenes,
                     study.scenes(), counts_text(edge_names, counts));
}

bool has(std::span<const BuildProblem> problems, BuildFault fault) {
  return std::ranges::count(problems, fault, &BuildProblem::fault) > 0;
}

/// In what the optimum of a scene cannot be built.
std::vector<BuildProblem> problems_of(const Study& study, std::uint64_t scene,
                                      const BestDesign& best) {
  if (!best.exists()) return {};
  return build_problems(scene_at(study.job(), scene), best.build);
}

/// In how many scenes of a study the optimum cannot be built, and why, with an example: the best of
/// all scenes if it is one of them. Empty if in none.
std::string build_text(const Study& study, const Summary& summary) {
  constexpr std::array faults{"below the ground", "a slack sling", "a compressed hanger"};
  std::array<std::uint64_t, faults.size()> counts{};
  std::uint64_t scenes = 0;
  std::string example;
  for (std::uint64_t scene = 0; scene < study.scenes(); ++scene) {
    const auto problems = problems_of(study, scene, summary.optima[scene]);
    if (problems.empty()) continue;
    for (std::size_t f = 0; f < faults.size(); ++f)
      counts[f] += has(problems, static_cast<BuildFault>(f));
    const bool is_best = summary.best() == scene;
    if (++scenes == 1 || is_best)
      example = fmt::format("{} with {}: {}", is_best ? "the best one," : "that",
                            outer_values_text(study.job(), scene), to_text(problems));
  }
  if (scenes == 0) return "";
  return fmt::format("the optimum of {} of {} scenes cannot be built: {}, such as {}", scenes,
                     study.scenes(), counts_text(faults, counts), example);
}

/// Warnings from the checks of one scene. `is_slack`: whether the sling of its optimum goes slack,
/// which is reported already.
std::vector<std::string> check_warnings(const Job& job, const BestDesign& optimum,
                                        const std::optional<MeasuredError>& error,
                                        std::span<const Check> checks, bool is_slack) {
  std::vector<std::string> lines;
  const double largest = largest_speed(optimum, checks);
  add(lines, status_warning(checks, job.solver));
  add(lines, efficiency_warning(checks, largest));
  if (error) add(lines, speed_warning(*error, largest, job.solver));
  if (optimum.exists() && !is_slack && job.output.optimum_filter == OptimumFilter::all &&
      job.scene.sling_stiffness == 0)
    add(lines, slack_warning(checks, optimum.value, shown(job.optimum.objective).text));
  return lines;
}

/// How many of the scenes checked, but one, have warnings, with an example; empty if none has.
std::string others_text(const Study& study, std::span<const ErrorSample> samples,
                        std::uint64_t but) {
  const Job& job = study.job();
  std::string example;
  std::uint64_t scenes = 0, others = 0;
  for (const ErrorSample& sample : samples) {
    if (sample.scene == but) continue;
    ++others;
    const auto lines =
        check_warnings(job_at(job, sample.scene), {}, measured_error({&sample, 1}, sample.scene),
                       sample.checks, false);
    if (lines.empty()) continue;
    ++scenes;
    example = fmt::format("{}: {}", outer_values_text(job, sample.scene), lines.front());
  }
  if (scenes == 0) return "";
  return fmt::format("{} of {} other scenes checked have warnings, such as that with {}", scenes,
                     others, example);
}

}  // namespace

std::vector<std::string> warnings(const Study& study, const SweepResult& result) {
  const auto& [summary, samples] = result;
  const Job& job = study.job();
  const std::uint64_t scene = summary.best().value_or(0);
  const BestDesign& best = summary.optima[scene];
  const auto problems = problems_of(study, scene, best);
  const auto sample = std::ranges::find(samples, scene, &ErrorSample::scene);
  const std::span<const Check> checks =
      sample == samples.end() ? std::span<const Check>() : std::span(sample->checks);

  std::vector<std::string> of_scene;
  add(of_scene, edge_warning(job_at(job, scene), best.design, edges_of(study, scene, best)));
  for (const std::string& line : check_warnings(job_at(job, scene), best, summary.error, checks,
                                                has(problems, BuildFault::slack_sling)))
    of_scene.push_back(line);

  std::vector<std::string> lines;
  if (!is_study(job)) {
    if (!problems.empty())
      lines.push_back(fmt::format("the optimum cannot be built: {}", to_text(problems)));
    lines.insert(lines.end(), of_scene.begin(), of_scene.end());
    return lines;
  }
  add(lines, build_text(study, summary));
  for (const std::string& line : of_scene)
    lines.push_back(fmt::format("the best scene, {}: {}", outer_values_text(job, scene), line));
  add(lines, others_text(study, samples, scene));
  add(lines, edges_text(study, summary.optima));
  return lines;
}

}  // namespace trebsweep
