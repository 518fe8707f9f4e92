#include "trebsweep/load_job.hpp"

#include <fmt/format.h>

#include "trebsweep/mpi.hpp"
#include "trebsweep/tolerance.hpp"

namespace trebsweep {

Job load_job(const std::string& path, const Overrides& overrides, MPI_Comm comm) {
  const std::string text = mpi::text_of_root(comm, [&] {
    Job job = parse_job(read_job_file(path), path, overrides);
    if (job.solver.target_error > 0) {
      job.solver.tolerance = tolerance_for_target(job);
      job.solver.target_error = 0;  // settled
      fmt::print(stderr, "tolerance {:.2g}\n", job.solver.tolerance);
    }
    return to_text(job, true);
  });
  return parse_job(text, "", {});
}

}  // namespace trebsweep
