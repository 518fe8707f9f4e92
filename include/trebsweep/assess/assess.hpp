#pragma once

#include <mpi.h>

#include <string>
#include <vector>

#include "trebsweep/assess/table.hpp"
#include "trebsweep/job/job.hpp"

namespace trebsweep {

/// How an assessment is run.
struct AssessOptions {
  bool overwrite = false;  ///< replace a file that is there
  bool progress = true;    ///< tell on stderr what is being done
  std::string command;     ///< as typed, for the file's history
};

/// Measures what the job's [assess] asks for, and writes it into the job's output file; collective.
/// The tables are the same on all ranks. Throws InputError, on all ranks, where the job, a file
/// that it names or the place of its output is at fault.
std::vector<Table> assess(const Job& job, const AssessOptions& options, MPI_Comm comm);

}  // namespace trebsweep
