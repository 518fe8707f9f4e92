#include "trebsweep/optimum/coarse_sweep.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "trebsweep/base/error.hpp"
#include "trebsweep/base/mpi.hpp"
#include "trebsweep/job/sample.hpp"
#include "trebsweep/optimum/design_problem.hpp"
#include "trebsweep/optimum/field_values.hpp"

namespace trebsweep {
namespace {

constexpr std::uint64_t enough_designs = 300'000;  // a fraction of a second
constexpr std::size_t enough_values = 200;         // of an axis
constexpr std::uint64_t max_designs = 100'000'000;

/// A value and a violation of the constraints, as of a Point.
struct Merit {
  double objective, violation;
};

bool is_released(const Merit& merit) { return !std::isinf(merit.violation); }

bool is_better(const Merit& a, const Merit& b) {
  return is_better(Point{{}, a.objective, a.violation}, Point{{}, b.objective, b.violation});
}

std::vector<Merit> merits(const Job& job, std::span<const Design<double>> designs) {
  const std::vector<Constraint> constraints = constraints_of(job);
  std::vector<Field> fields{job.optimum.objective};
  for (const Constraint& c : constraints) fields.push_back(c.field);
  const Eigen::MatrixXd values =
      field_values(job.scene, job.solver, Accuracy::coarse, designs, fields);
  std::vector<Merit> all;
  for (const auto& column : values.colwise()) {
    Merit merit{column(0), 0};
    for (std::size_t i = 0; i < constraints.size(); ++i)
      merit.violation =
          std::max(merit.violation,
                   violation(constraints[i], column(static_cast<Eigen::Index>(i) + 1)) /
                       (std::abs(constraints[i].limit) > 0 ? std::abs(constraints[i].limit) : 1));
    if (!column.allFinite()) merit = {0, HUGE_VAL};
    all.push_back(merit);
  }
  return all;
}

/// The merits of designs, each computed by one of the ranks. Collective.
std::vector<Merit> merits_on_all_ranks(const Job& job, std::span<const Design<double>> designs,
                                       ProgressStyle style, MPI_Comm comm) {
  constexpr std::size_t part = 2048;
  Progress progress(0, designs.size(), style);
  const std::size_t round = part * static_cast<std::size_t>(mpi::size(comm));
  std::vector<Merit> all(designs.size());
  for (auto first = part * static_cast<std::size_t>(mpi::rank(comm)); first < designs.size();
       first += round) {
    const auto some = designs.subspan(first, std::min(part, designs.size() - first));
    std::ranges::copy(merits(job, some), all.begin() + static_cast<std::ptrdiff_t>(first));
    progress.update(std::min(first + round, designs.size()));
  }
  mpi::merge(std::span(all), comm);
  return all;
}

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

/// The designs that none of their neighbours exceeds; of equal neighbours, the first.
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
    if (place[cell] != none && is_released(merit[place[cell]]) &&
        exceeds_neighbours(cell / n[2] / n[1], cell / n[2] % n[1], cell % n[2], place[cell]))
      maxima.push_back(place[cell]);
  return maxima;
}

}  // namespace

LatticeSpec coarse_lattice(const Scene& scene, const LatticeSpec& spec) {
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
  const std::vector<Merit> merit = merits_on_all_ranks(job, designs, style, comm);
  std::vector<std::size_t> maxima = local_maxima(lattice, merit);
  std::ranges::stable_sort(
      maxima, [&](std::size_t a, std::size_t b) { return is_better(merit[a], merit[b]); });
  CoarseSweep sweep{.increment = designs.size() > 1 ? spec.increment : 0,
                    .designs = designs.size(),
                    .maxima = {}};
  for (const std::size_t m : maxima) sweep.maxima.push_back(designs[m]);
  return sweep;
}

}  // namespace trebsweep
