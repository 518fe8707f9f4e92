#include "support/archive_reader.hpp"
#include "support/catch.hpp"
#include "support/paper_algorithm.hpp"
#include "support/quiet_sweep.hpp"
#include "trebsweep/job/config_file.hpp"

using namespace trebsweep;

TEST_CASE("On the whole lattice, the paper's job agrees with the paper's algorithm to 1e-9") {
  const TemporaryFile file("paper");
  Job job = parse_job(read_job_file(SOURCE_DIR "/jobs/paper.cfg"), "paper.cfg", {});
  job.output.file = file.path();
  const Summary summary = summary_of(job);
  CHECK(summary.tally.designs() == 706860);
  CHECK(summary.tally.statuses[static_cast<std::size_t>(Status::released)] == 706860);
  CHECK(summary.tally.steps == 50335710);
  const BestDesign best = best_of(summary);
  CHECK(best.speed == Approx(17.47606519).margin(5e-9));
  CHECK(best.design.r1 == 0.51);
  CHECK(best.design.r2 == 0.91);
  CHECK(best.design.r3 == 0.58);
  if (mpi::size(MPI_COMM_WORLD) > 1) return;  // the maps are the same on any number of ranks

  const auto speed = read_map(file.path(), "speed"), time = read_map(file.path(), "release_time");
  const auto status = read_map(file.path(), "status");
  std::size_t designs = 0, released = 0, equal = 0;
  paper::sweep([&](const paper::SwingResult& result, int i1, int i3, int i2) {
    const auto cell = static_cast<std::size_t>(((i1 - 51) * 120 + i3 - 30) * 119 + i2 - 1);
    ++designs;
    released += status[cell] == static_cast<double>(Status::released) && result.step > 0;
    const double dv = std::abs(speed[cell] - result.speed), dt = std::abs(time[cell] - result.time);
    equal += dv < 1e-9 && dt < 1e-9;  // false for NaN
  });
  CHECK(designs == 706860);
  CHECK(released == designs);
  CHECK(equal == designs);
}
