#include "trebsweep/optimum/coarse_grid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "trebsweep/base/error.hpp"
#include "trebsweep/job/sample.hpp"
#include "trebsweep/model/start.hpp"
#include "trebsweep/optimum/design_problem.hpp"
#include "trebsweep/optimum/nonlinear_program.hpp"
#include "trebsweep/optimum/sobol.hpp"

namespace trebsweep {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::size_t enough_values = 200;  // of an axis
constexpr std::size_t enough_maxima = 48;
constexpr std::uint64_t max_designs = 100'000'000;

LatticeSpec with_increment(LatticeSpec spec, double increment) {
  spec.increment = increment;
  for (auto* axis : {&spec.r1, &spec.r3, &spec.r2})
    if (*axis && (*axis)->first < (*axis)->last) {
      const double width = (*axis)->last - (*axis)->first;
      (*axis)->step = width / std::max(1.0, std::ceil(width / increment - 1e-6));
    }
  return spec;
}

/// The number of lengths that a job searches.
Index free_lengths(const Job& job) {
  const LatticeSpec& spec = job.lattice;
  return std::ranges::count_if(std::array{&spec.r1, &spec.r3, &spec.r2}, [](const auto* axis) {
    return !*axis || (*axis)->first < (*axis)->last;
  });
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
std::vector<std::size_t> local_maxima(const Lattice& lattice, std::span<const Merit> merit) {
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
  return maxima;
}

/// Which designs can satisfy constraints, as far as is known without their swings.
class StartFilter {
 public:
  explicit StartFilter(const std::vector<Constraint>& constraints) {
    for (const Constraint& c : constraints)
      if (c.expression.fields.empty())
        of_lengths_.push_back(c);
      else if (field_of(c.expression) == Field::tip_clearance && !c.is_upper)
        of_tip_.push_back(c);
  }

  bool passes(const Scene& scene, const Design<double>& design) const {
    if (!start_is_reachable(scene, design) || !sling_reaches_trough(scene, design)) return false;
    const auto holds = [&](const Constraint& c, double value) {
      return violation(c, value) / scale_of(c, scene, value) <= feasibility_tolerance;
    };
    for (const Constraint& c : of_lengths_)
      if (!holds(c, c.expression.value({scene, design, {}, {}}))) return false;
    if (of_tip_.empty()) return true;
    const double tip = scene.fulcrum_height - design.r2 * std::cos(start_angle(scene, design));
    return std::ranges::all_of(of_tip_, [&](const Constraint& c) { return holds(c, tip); });
  }

 private:
  std::vector<Constraint> of_lengths_, of_tip_;  // of keys and lengths alone; of the arm's tip
};

/// How many scenes a Sobol sequence has, and designs of each.
struct SobolCounts {
  std::uint64_t scenes, designs;
};

/// Designs of a space for which a condition holds, in scenes that have any. Where few have, more
/// are tried; until the first is found, in more scenes.
template <class Condition>
std::vector<Parameters> sobol_designs(const Job& job, const DesignSpace& space, SobolCounts counts,
                                      Condition holds) {
  constexpr std::uint64_t few_tries = 8, most_tries = 64, first_tries = 100;
  const auto k = std::ssize(job.optimum.variables);
  SobolSequence variables(space.lower.tail(k), space.upper.tail(k));
  SobolSequence lengths(space.lower.head(length_count), space.upper.head(length_count));
  std::vector<Parameters> found;
  std::uint64_t with_designs = 0, most_scenes = first_tries * counts.scenes;
  for (std::uint64_t i = 0; with_designs < counts.scenes && i < most_scenes; ++i) {
    const VectorXd values = variables.next();
    const Scene scene = with_variables(job, values).scene;
    const std::size_t before = found.size(), enough = before + counts.designs;
    const std::uint64_t tries = found.empty() || counts.designs == 1 ? few_tries : most_tries;
    for (std::uint64_t j = 0; j < tries * counts.designs && found.size() < enough; ++j) {
      const VectorXd of_lengths = lengths.next();
      const Design<double> design = to_design(of_lengths);
      const auto is_beyond = [&](const SpaceLimit& l) { return l.excess(scene, design) >= 0; };
      if (std::ranges::none_of(space.limits, is_beyond) && holds(scene, design))
        found.emplace_back(space.size()) << of_lengths, values;
    }
    if (found.size() == before) continue;
    if (with_designs++ == 0) most_scenes = i + most_tries * counts.scenes;
  }
  return found;
}

}  // namespace

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

Lattice checked_lattice(const Scene& scene, const LatticeSpec& spec) {
  Lattice lattice(scene, spec);
  if (lattice.designs() > max_designs)
    refuse("lattice.increment", fmt::format("{}", spec.increment),
           fmt::format("larger: the coarse sweep would have {} designs, and {} are allowed",
                       lattice.designs(), max_designs));
  return lattice;
}

Grid lattice_grid(const Scene& scene, const LatticeSpec& spec) {
  const Lattice lattice = checked_lattice(scene, spec);
  Grid grid{MatrixXd(length_count, lattice.designs()),
            lattice,
            lattice.designs() > 1 ? spec.increment : 0,
            {}};
  for (Index column = 0; const Design<double>& design : all_designs(lattice))
    grid.parameters.col(column++) = to_parameters(design);
  return grid;
}

Grid sobol_grid(const Job& job, std::uint64_t designs) {
  const DesignSpace space = design_space(job);
  const auto k = std::ssize(job.optimum.variables), n = k + free_lengths(job);
  const auto values_each = std::pow(static_cast<double>(designs), 1 / static_cast<double>(n));
  const auto scenes = static_cast<std::uint64_t>(std::pow(values_each, k));
  const SobolCounts counts{scenes, free_lengths(job) == 0 ? 1 : designs / scenes};
  const StartFilter filter(constraints_of(job));
  std::vector<Parameters> found =
      sobol_designs(job, space, counts, [&](const Scene& scene, const Design<double>& design) {
        return filter.passes(scene, design);
      });
  // The search then says what excludes all designs.
  if (found.empty())
    found =
        sobol_designs(job, space, counts, [](const Scene&, const Design<double>&) { return true; });
  if (found.empty())
    throw NoOptimum(
        "the design space is empty: none of the lengths tried is possible with the "
        "values of the variables tried");
  Grid grid{MatrixXd(space.size(), std::ssize(found)), {}, 0, {}};
  for (Index column = 0; const Parameters& parameters : found)
    grid.parameters.col(column++) = parameters;
  grid.spacing = (space.upper - space.lower) / values_each;
  return grid;
}

std::vector<std::size_t> local_maxima(const Grid& grid, std::span<const Merit> merit) {
  if (grid.lattice) {
    auto maxima = local_maxima(*grid.lattice, merit);
    std::ranges::stable_sort(
        maxima, [&](std::size_t a, std::size_t b) { return is_better(merit[a], merit[b]); });
    return maxima;
  }
  constexpr std::size_t compared = 5'000;
  constexpr double near = 1;
  std::vector<std::size_t> best(merit.size());
  std::iota(best.begin(), best.end(), std::size_t{0});
  std::erase_if(best, [&](std::size_t i) { return std::isinf(merit[i].violation); });
  std::ranges::stable_sort(
      best, [&](std::size_t a, std::size_t b) { return is_better(merit[a], merit[b]); });
  best.resize(std::min(best.size(), compared));
  const auto is_near = [&](std::size_t a, std::size_t b) {
    const auto difference =
        grid.parameters.col(static_cast<Index>(a)) - grid.parameters.col(static_cast<Index>(b));
    return (difference.array().abs() <= near * grid.spacing.array()).all();
  };
  std::vector<std::size_t> maxima;
  for (auto i = best.begin(); i != best.end() && maxima.size() < enough_maxima; ++i)
    if (std::none_of(best.begin(), i, [&](std::size_t better) { return is_near(better, *i); }))
      maxima.push_back(*i);
  return maxima;
}

}  // namespace trebsweep
