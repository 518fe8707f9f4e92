#include "trebsweep/optimum/coarse_grid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <boost/random/sobol.hpp>
#include <boost/random/uniform_real_distribution.hpp>
#include <cmath>

#include "trebsweep/base/error.hpp"
#include "trebsweep/job/sample.hpp"
#include "trebsweep/optimum/nonlinear_program.hpp"

namespace trebsweep {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::size_t enough_values = 200;  // of an axis
constexpr std::size_t enough_maxima = 16;
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

/// The lattice of a scene, or nothing if it is empty.
std::optional<Lattice> lattice_in(const Job& job, const VectorXd& values, const LatticeSpec& spec) {
  try {
    return Lattice(with_variables(job, values).scene, spec);
  } catch (const InputError&) {
    return std::nullopt;
  }
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

}  // namespace

MatrixXd coarse_scenes(const Job& job, std::uint64_t designs) {
  const auto& variables = job.optimum.variables;
  const auto k = std::ssize(variables);
  if (k == 0) return MatrixXd(0, 1);
  const double part = static_cast<double>(k) / static_cast<double>(k + free_lengths(job));
  const auto count = static_cast<Index>(std::lround(std::pow(static_cast<double>(designs), part)));
  MatrixXd scenes(k, count);
  boost::random::sobol sequence(variables.size());
  for (auto scene : scenes.colwise())
    for (Index i = 0; const Variable& v : variables)
      scene(i++) = boost::random::uniform_real_distribution(v.lower, v.upper)(sequence);
  return scenes;
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

Grid grid_of(const Job& job, const LatticeSpec& spec, const MatrixXd& scenes) {
  Grid grid;
  std::vector<VectorXd> values;
  std::uint64_t designs = 0;
  for (const auto& scene : scenes.colwise())
    if (const auto lattice = lattice_in(job, scene, spec)) {
      grid.lattices.push_back(*lattice);
      values.emplace_back(scene);
      designs += lattice->designs();
    }
  if (grid.lattices.empty()) Lattice(with_variables(job, scenes.col(0)).scene, spec);  // throws
  if (designs > max_designs)
    refuse("lattice.increment", fmt::format("{}", spec.increment),
           fmt::format("larger: the coarse sweep would have {} designs, and {} are allowed",
                       designs, max_designs));
  grid.parameters.resize(length_count + scenes.rows(), static_cast<Index>(designs));
  Index column = 0;
  for (std::size_t i = 0; i < values.size(); ++i)
    for (const Design<double>& design : all_designs(grid.lattices[i]))
      grid.parameters.col(column++) << to_parameters(design), values[i];
  grid.spacing = VectorXd::Constant(grid.parameters.rows(), spec.increment);
  const double values_each =
      std::pow(static_cast<double>(scenes.cols()), 1.0 / static_cast<double>(scenes.rows()));
  for (Index i = length_count; const Variable& variable : job.optimum.variables)
    grid.spacing(i++) = (variable.upper - variable.lower) / values_each;
  return grid;
}

std::vector<std::size_t> local_maxima(const Grid& grid, std::span<const Merit> merit) {
  constexpr double near = 1;
  std::vector<std::size_t> maxima;
  for (std::size_t first = 0; const Lattice& lattice : grid.lattices) {
    const auto count = static_cast<std::size_t>(lattice.designs());
    for (const std::size_t m : local_maxima(lattice, merit.subspan(first, count)))
      maxima.push_back(first + m);
    first += count;
  }
  std::ranges::stable_sort(
      maxima, [&](std::size_t a, std::size_t b) { return is_better(merit[a], merit[b]); });
  if (grid.lattices.size() == 1) return maxima;
  const auto place = [&](std::size_t m) {
    return grid.parameters.col(static_cast<Index>(m)).cwiseQuotient(grid.spacing);
  };
  std::vector<std::size_t> distinct;
  for (std::size_t i = 0; i < maxima.size() && distinct.size() < enough_maxima; ++i)
    if (std::none_of(maxima.begin(), maxima.begin() + static_cast<std::ptrdiff_t>(i),
                     [&](std::size_t better) {
                       return (place(better) - place(maxima[i])).lpNorm<Eigen::Infinity>() < near;
                     }))
      distinct.push_back(maxima[i]);
  return distinct;
}

}  // namespace trebsweep
