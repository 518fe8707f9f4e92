#pragma once

#include <mpi.h>

#include <string>
#include <vector>

#include "trebsweep/job/job.hpp"
#include "trebsweep/swing/reference.hpp"

namespace trebsweep {

/// A scene to assess, with a sample of its lattice's designs.
struct Case {
  std::string name;  ///< its file's, without folder and suffix
  Job job;
  bool extreme;  ///< to be tried with its own step and tolerance alone
  /// The optimum of the lattice first, where it is known.
  std::vector<Design<double>> designs;
  std::vector<Reference> references;
};

/// The cases of a job's [assess], without references; collective. Throws InputError where one of
/// the files is at fault.
std::vector<Case> make_cases(const Job& job, MPI_Comm comm);

/// Computes the references of all cases' designs, dealt to the ranks one by one; collective.
void compute_references(std::vector<Case>& cases, MPI_Comm comm);

}  // namespace trebsweep
