#include "trebsweep/optimum/coarse_sweep.hpp"

#include <map>

#include "optimum/jobs.hpp"
#include "support/catch.hpp"
#include "trebsweep/base/error.hpp"
#include "trebsweep/base/mpi.hpp"
#include "trebsweep/job/sample.hpp"
#include "trebsweep/optimum/coarse_grid.hpp"

using namespace trebsweep;

namespace {

LatticeSpec with_increment(double increment) {
  LatticeSpec spec;
  spec.increment = increment;
  return spec;
}

using Cell = std::array<long, 3>;

/// The designs of a lattice whose value none of their neighbours exceeds, best first.
std::vector<Design<double>> brute_force(const Job& job, const Lattice& lattice) {
  const std::vector<Design<double>> designs = all_designs(lattice);
  const std::vector<double> values = accurate_objectives(job, designs);
  std::map<Cell, double> cells;
  const auto cell = [&](const Design<double>& design) {
    const Index3 i = lattice.index_of(design);
    return Cell{static_cast<long>(i[0]), static_cast<long>(i[1]), static_cast<long>(i[2])};
  };
  for (std::size_t n = 0; n < designs.size(); ++n)
    if (!std::isnan(values[n])) cells[cell(designs[n])] = values[n];
  std::vector<std::pair<double, Design<double>>> maxima;
  for (std::size_t n = 0; n < designs.size(); ++n) {
    if (std::isnan(values[n])) continue;
    const Cell centre = cell(designs[n]);
    bool is_maximum = true;
    for (const auto& [other, value] : cells) {
      bool near = true;
      for (std::size_t d = 0; d < 3; ++d) near = near && std::abs(other[d] - centre[d]) <= 1;
      is_maximum = is_maximum && (!near || value <= values[n]);
    }
    if (is_maximum) maxima.push_back({values[n], designs[n]});
  }
  std::ranges::sort(maxima, [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<Design<double>> sorted;
  for (const auto& [value, design] : maxima) sorted.push_back(design);
  return sorted;
}

CoarseSweep sweep_of(const Job& job, MPI_Comm comm = MPI_COMM_WORLD) {
  return coarse_sweep(job, lattice_grid(job.scene, job.lattice), ProgressStyle::none, comm);
}

}  // namespace

TEST_CASE("A coarse lattice keeps the ends of explicit axes and fixed lengths", "[alone]") {
  LatticeSpec spec;
  spec.r1 = AxisRange{0.513, 0.777, 1e-6};
  spec.r3 = AxisRange{0.6, 0.6, 1};
  const LatticeSpec coarse = coarse_lattice(Scene{}, spec);
  const Lattice lattice(Scene{}, coarse);
  CHECK(lattice.axes()[0].front() == 0.513);
  CHECK(lattice.axes()[0].back() == Approx(0.777).epsilon(1e-14));
  CHECK(lattice.axes()[1] == std::vector{0.6});
  CHECK(lattice.designs() > 1000);
}

TEST_CASE("The increment of a coarse lattice follows the size of the machine", "[alone]") {
  Scene large;
  large.release_height = 200;
  large.fulcrum_height = 150;
  LatticeSpec of_large;
  of_large.shortest_sling = 30;
  const LatticeSpec spec = coarse_lattice(Scene{}, {});
  CHECK(coarse_lattice(large, of_large).increment == Approx(100 * spec.increment));
  const auto designs = Lattice(Scene{}, spec).designs();
  CHECK(designs > 10'000);
  CHECK(designs < 1'000'000);
}

TEST_CASE("The maxima are those that a comparison of all neighbours finds, best first", "[alone]") {
  Job speed, range, hanger;
  range.optimum.objective = to_expression(Field::range);
  hanger.scene.start_angle = 1.2;
  hanger.scene.counterweight_hanger = 0.2;
  for (Job job : {speed, range, hanger}) {
    job.lattice = with_increment(0.1);
    const CoarseSweep sweep = sweep_of(job);
    const Lattice lattice(job.scene, job.lattice);
    CHECK(sweep.designs == lattice.designs());
    const auto expected = brute_force(job, lattice);
    REQUIRE(sweep.maxima.size() == expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i)
      CHECK(to_design(sweep.maxima[i]) == expected[i]);
  }
}

TEST_CASE("Designs that satisfy the constraints come before others", "[alone]") {
  Job job = job_with({{"optimum.subject-to", "peak-axle-load <= 1.75e5"}});
  job.lattice = with_increment(0.1);
  const auto maxima = sweep_of(job).maxima;
  REQUIRE_FALSE(maxima.empty());
  const auto designs = all_designs(Lattice(job.scene, job.lattice));
  const auto speeds = accurate_values(job, Field::speed, designs);
  const auto loads = accurate_values(job, Field::peak_axle_load, designs);
  double best = 0;
  for (std::size_t n = 0; n < designs.size(); ++n)
    if (loads[n] <= 1.75e5) best = std::max(best, speeds[n]);
  REQUIRE(best > 0);
  CHECK(accurate_value(job, Field::speed, to_design(maxima.front())) == best);
  job.optimum.constraints.front().limit = 1;  // which all designs violate
  const auto violating = sweep_of(job).maxima;
  REQUIRE_FALSE(violating.empty());
  CHECK(accurate_value(job, Field::peak_axle_load, to_design(violating.front())) ==
        *std::ranges::min_element(loads, {}, [](double v) { return std::isnan(v) ? 1e300 : v; }));
}

TEST_CASE("A coarse sweep is the same on any number of ranks") {
  Job job;
  job.lattice = with_increment(0.04);
  const auto together = sweep_of(job).maxima, alone = sweep_of(job, MPI_COMM_SELF).maxima;
  CHECK(together == alone);
  CHECK_FALSE(together.empty());
}

TEST_CASE("There are no maxima where nothing is released", "[alone]") {
  Job job;
  job.solver.max_time = 0.2;
  job.lattice = with_increment(0.1);
  CHECK(sweep_of(job).maxima.empty());
}

TEST_CASE("A coarse sweep of more than 100 million designs is refused") {
  Job job;
  job.lattice = with_increment(1e-3);
  CHECK_THROWS_AS(sweep_of(job), InputError);
}
