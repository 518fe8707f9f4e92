#pragma once

#include <mpi.h>

#include <string>
#include <vector>

#include "trebsweep/assess/table.hpp"
#include "trebsweep/job/job.hpp"

namespace trebsweep {

/// Options that do not change the results of an assessment.
struct AssessOptions {
  bool overwrite = false;  ///< replace an existing file
  bool progress = true;    ///< report each stage on stderr
  std::string command;     ///< the command line, for the file's history
  std::string job_name;    ///< names the job's own scene
};

/// Measures what the job's [assess] asks for and writes the tables to the job's output file;
/// collective. Returns the same tables on all ranks. Throws InputError, on all ranks, if the job, a
/// file that it names or the path of its output is invalid.
std::vector<Table> assess(const Job& job, const AssessOptions& options, MPI_Comm comm);

}  // namespace trebsweep
