#include "trebsweep/archive/summary.hpp"

#include <cmath>

#include "support/catch.hpp"
#include "trebsweep/base/mpi.hpp"

using namespace trebsweep;

namespace {

SwingResult released(double speed, double time) { return {speed, time, 10, Status::released}; }

const Lattice paper_lattice{Scene{}, LatticeSpec{}};

}  // namespace

TEST_CASE(
    "The optimum is the fastest design of all ranks, and of equal ones the first in the lattice") {
  const auto rank = static_cast<std::uint64_t>(mpi::rank(MPI_COMM_WORLD));
  const auto ranks = static_cast<std::uint64_t>(mpi::size(MPI_COMM_WORLD));
  Tally tally;
  tally.add(released(1, 0.1), rank);
  tally.add(released(7, 0.5), 1000 - rank);  // the same speed on every rank
  tally.add(released(7, 0.6), 2000 + rank);
  tally.add({99, 0, 5, Status::not_released}, 0);
  const Summary summary = combine(tally, paper_lattice, MPI_COMM_WORLD);
  CHECK(summary.designs() == 4 * ranks);
  CHECK(summary.statuses[static_cast<std::size_t>(Status::released)] == 3 * ranks);
  CHECK(summary.statuses[static_cast<std::size_t>(Status::not_released)] == ranks);
  CHECK(summary.steps == 35 * ranks);
  REQUIRE(summary.optimum);
  CHECK(summary.first_of_statuses ==
        std::vector{paper_lattice.design({0, 0, 0}), paper_lattice.design({0, 0, 0})});
  CHECK(summary.optimum->speed == 7);
  CHECK(summary.optimum->release_time == 0.5);
  const std::uint64_t cell = 1000 - (ranks - 1);
  const Design<double> design = paper_lattice.design({0, cell / 119, cell % 119});
  CHECK(summary.optimum->design.r3 == design.r3);
  CHECK(summary.optimum->design.r2 == design.r2);
}

TEST_CASE("An optimum found by one rank is known to all ranks") {
  Tally tally;
  if (mpi::rank(MPI_COMM_WORLD) == mpi::size(MPI_COMM_WORLD) - 1)
    tally.add(released(0, 0.9), 5);  // a speed of 0 counts too
  const Summary summary = combine(tally, paper_lattice, MPI_COMM_WORLD);
  REQUIRE(summary.optimum);
  CHECK(summary.optimum->release_time == 0.9);
}

TEST_CASE("Without a release the summary has no optimum, and its text reports that") {
  Tally tally;
  tally.add({0, 0, 1, Status::non_finite}, 0);
  const Summary summary = combine(tally, paper_lattice, MPI_COMM_WORLD);
  CHECK_FALSE(summary.optimum);
  CHECK_THAT(to_text(summary, OptimumFilter::all),
             contains("non_finite") && contains("optimum   none"));
}

TEST_CASE("The text gives the measured error") {
  Summary summary;
  CHECK_THAT(to_text(summary, OptimumFilter::all), contains("error     not measured\n"));
  summary.error = MeasuredError{8e-10, 1.5e-8, 4e-9, 128};
  CHECK_THAT(to_text(summary, OptimumFilter::all),
             contains("error     8e-10 median, 1.5e-08 largest of 128 designs; 4e-09 at the "
                      "optimum\n"));
  summary.error->at_optimum = std::nan("");
  CHECK_THAT(to_text(summary, OptimumFilter::all), contains("of 128 designs\n"));
}

TEST_CASE("The text gives the optimal design with all its digits") {
  Summary summary;
  summary.optimum = Optimum{{0.512345678, 0.58, 0.91}, 16.5, 0.9};
  CHECK_THAT(to_text(summary, OptimumFilter::all),
             contains("r1 = 0.512345678, r2 = 0.91, r3 = 0.58 m"));
}
