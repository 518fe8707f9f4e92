#pragma once

#include <mpi.h>

#include <string>
#include <vector>

#include "trebsweep/job/job.hpp"

namespace trebsweep {

/// Reads a job file, or stdin_path, for parse_job(). A target error is replaced by the tolerance
/// that meets it, which is printed to stderr. Throws InputError.
Job load_job(const std::string& path, const Overrides& overrides,
             const std::vector<std::string>& unset = {}, const std::string& ending = ".h5");

/// The same on every rank, where only rank 0 reads files. Collective. Throws InputError on all
/// ranks.
Job load_job(const std::string& path, const Overrides& overrides, MPI_Comm comm,
             const std::vector<std::string>& unset = {}, const std::string& ending = ".h5");

}  // namespace trebsweep
