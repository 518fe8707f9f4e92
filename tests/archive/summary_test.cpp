#include "trebsweep/archive/summary.hpp"

#include <limits>

#include "support/catch.hpp"
#include "trebsweep/base/mpi.hpp"

using namespace trebsweep;

namespace {

SwingResult released(double speed, double time) { return {speed, time, 10, Status::released}; }

constexpr double no_value = std::numeric_limits<double>::quiet_NaN();

const Lattice paper_lattice{Scene{}, LatticeSpec{}};

}  // namespace

TEST_CASE(
    "The optimum has the largest objective of all ranks, and of equal ones is the first in the "
    "lattice") {
  const auto rank = static_cast<std::uint64_t>(mpi::rank(MPI_COMM_WORLD));
  const auto ranks = static_cast<std::uint64_t>(mpi::size(MPI_COMM_WORLD));
  Tally tally;
  tally.add(released(8, 0.1), rank, -9);
  tally.add(released(7, 0.5), 1000 - rank, -3);  // the same objective on every rank
  tally.add(released(7, 0.6), 2000 + rank, -3);
  tally.add({99, 0, 5, Status::not_released}, 0, 99);
  const Summary summary = combine(tally, paper_lattice, MPI_COMM_WORLD);
  CHECK(summary.designs() == 4 * ranks);
  CHECK(summary.statuses[static_cast<std::size_t>(Status::released)] == 3 * ranks);
  CHECK(summary.statuses[static_cast<std::size_t>(Status::not_released)] == ranks);
  CHECK(summary.steps == 35 * ranks);
  REQUIRE(summary.optimum);
  CHECK(summary.first_of_statuses ==
        std::vector{paper_lattice.design({0, 0, 0}), paper_lattice.design({0, 0, 0})});
  CHECK(summary.optimum->value == -3);
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
    tally.add(released(0, 0.9), 5, 0);  // a speed of 0 counts too
  const Summary summary = combine(tally, paper_lattice, MPI_COMM_WORLD);
  REQUIRE(summary.optimum);
  CHECK(summary.optimum->release_time == 0.9);
}

TEST_CASE("Without a release the summary has no optimum, and its text reports that") {
  Tally tally;
  tally.add({no_value, no_value, 1, Status::non_finite}, 0, no_value);
  const Summary summary = combine(tally, paper_lattice, MPI_COMM_WORLD);
  CHECK_FALSE(summary.optimum);
  CHECK_THAT(to_text(summary, Job{}),
             contains("non_finite") && contains("optimum   none: nothing was released\n"));
}

TEST_CASE("If released designs are excluded, the text says by what") {
  Tally tally;
  tally.add(released(7, 0.5), 0, no_value);
  const Summary summary = combine(tally, paper_lattice, MPI_COMM_WORLD);
  CHECK_FALSE(summary.optimum);
  Job job;
  job.output.optimum_filter = OptimumFilter::taut;
  CHECK_THAT(to_text(summary, job),
             contains("optimum   none: no released design has a taut sling\n"));
  job.optimum = {Field::range, {{Field::apex, true, 3}}};
  CHECK_THAT(to_text(summary, job),
             contains("optimum   none: no released design has a finite range and has a taut sling "
                      "and satisfies the constraints\n"));
}

TEST_CASE("The optimum's objective is printed with its unit, and so are the constraints") {
  Summary summary;
  summary.optimum = Optimum{{0.5, 0.58, 0.91}, 27.01, 15.5, 0.75};
  const std::string place = " at r1 = 0.5, r2 = 0.91, r3 = 0.58 m, released at 0.75 s";
  Job job;
  CHECK_THAT(to_text(summary, job), contains("optimum   15.50000000 m/s" + place + "\n"));
  job.optimum.objective = Field::range;
  CHECK_THAT(to_text(summary, job),
             contains("optimum   range 27.01 m" + place + " with 15.50000000 m/s\n"));
  job.optimum = {Field::efficiency,
                 {{Field::peak_axle_load, true, 150000}, {Field::least_sling_tension, false, 0}}};
  job.output.optimum_filter = OptimumFilter::taut;
  CHECK_THAT(to_text(summary, job),
             contains("optimum   efficiency 27.01" + place +
                      " with 15.50000000 m/s, the sling taut, subject to peak-axle-load <= 150000, "
                      "least-sling-tension >= 0\n"));
}

TEST_CASE("The text gives the measured error") {
  Summary summary;
  CHECK_THAT(to_text(summary, Job{}), contains("error     not measured\n"));
  summary.error = MeasuredError{8e-10, 1.5e-8, 4e-9, 128};
  CHECK_THAT(to_text(summary, Job{}),
             contains("error     8e-10 median, 1.5e-08 largest of 128 designs; 4e-09 at the "
                      "optimum\n"));
  summary.error->at_optimum = no_value;
  CHECK_THAT(to_text(summary, Job{}), contains("of 128 designs\n"));
  Job job;
  job.optimum.objective = Field::range;
  CHECK_THAT(to_text(summary, job), contains("of 128 designs (of the speed, m/s)\n"));
}

TEST_CASE("The text gives the optimal design with all its digits") {
  Summary summary;
  summary.optimum = Optimum{{0.512345678, 0.58, 0.91}, 16.5, 16.5, 0.9};
  CHECK_THAT(to_text(summary, Job{}), contains("r1 = 0.512345678, r2 = 0.91, r3 = 0.58 m"));
}
