#pragma once

#include <mpi.h>

#include <string>

#include "trebsweep/job/job.hpp"

namespace trebsweep {

/// The job of a job file. A target error becomes the tolerance that reaches it, which is printed on
/// stderr. Throws InputError.
Job load_job(const std::string& path, const Overrides& overrides);

/// The same on every rank; rank 0 alone reads the files. Collective. Throws InputError on all
/// ranks.
Job load_job(const std::string& path, const Overrides& overrides, MPI_Comm comm);

}  // namespace trebsweep
