#pragma once

#include <mpi.h>

#include <string>

#include "trebsweep/job.hpp"

namespace trebsweep {

/// The job of a job file, the same on every rank: rank 0 alone reads the file, and the scene file
/// that it may name. A target error has become the tolerance that reaches it, which rank 0 tells on
/// stderr. Collective. Throws InputError, on all ranks.
Job load_job(const std::string& path, const Overrides& overrides, MPI_Comm comm);

}  // namespace trebsweep
