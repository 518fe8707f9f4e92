#include "trebsweep/job/load_job.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <boost/algorithm/string.hpp>

#include "trebsweep/base/message.hpp"
#include "trebsweep/base/mpi.hpp"
#include "trebsweep/job/config_file.hpp"
#include "trebsweep/job/tolerance.hpp"

namespace trebsweep {

Job load_job(const std::string& path, const Overrides& overrides,
             const std::vector<std::string>& unset, const std::string& ending) {
  const std::string text = path == stdin_path ? read_job_from_stdin() : read_job_file(path);
  Job job = parse_job(text, path, overrides, ending, unset);
  if (job.solver.target_error > 0) {
    job.solver.tolerance = tolerance_for_target(job);
    job.solver.target_error = 0;  // replaced by the tolerance
    print_message(fmt::format("tolerance {:.2g}\n", job.solver.tolerance));
  }
  return job;
}

Job load_job(const std::string& path, const Overrides& overrides, MPI_Comm comm,
             const std::vector<std::string>& unset, const std::string& ending) {
  std::string scene_files;  // one per line
  const std::string text = mpi::text_of_root(comm, [&] {
    const Job job = load_job(path, overrides, unset, ending);
    scene_files = fmt::format("{}", fmt::join(job.scene_files, "\n"));
    return to_text(job, true);
  });
  Job job = parse_job(text, "", {});
  scene_files = mpi::broadcast(scene_files, comm);
  if (!scene_files.empty()) boost::split(job.scene_files, scene_files, boost::is_any_of("\n"));
  return job;
}

}  // namespace trebsweep
