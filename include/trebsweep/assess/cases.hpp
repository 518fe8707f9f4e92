#pragma once

#include <mpi.h>

#include <string>
#include <vector>

#include "trebsweep/job/job.hpp"
#include "trebsweep/swing/reference.hpp"

namespace trebsweep {

/// A scene to assess solvers on, with a sample of its lattice.
struct Case {
  std::string name;  ///< the stem of its file's name
  Job job;
  bool extreme;  ///< assessed only with the step and tolerance of its own job
  std::vector<Design<double>> designs;  ///< the lattice's optimum first, if it is known
  std::vector<Reference> references;    ///< references[n] belongs to designs[n]
};

/// The cases that a job's [assess] names, or the job's own scene, called `own`, if it names
/// none. References are left empty. Collective. Throws InputError if one of the files is invalid.
std::vector<Case> make_cases(const Job& job, const std::string& own, MPI_Comm comm);

/// Computes the references of all cases, sharing the designs among the ranks; collective.
void compute_references(std::vector<Case>& cases, MPI_Comm comm);

}  // namespace trebsweep
