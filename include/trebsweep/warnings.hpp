#pragma once

#include <mpi.h>

#include <string>
#include <vector>

#include "trebsweep/job.hpp"
#include "trebsweep/lattice.hpp"
#include "trebsweep/summary.hpp"

namespace trebsweep {

/// What makes the result of a complete sweep doubtful, a line for each cause: designs with an
/// efficiency above 1, designs whose status a fixed step changes, an optimum on the edge of the
/// lattice, and slings that would go slack among the best designs. Integrates a sample of the
/// lattice and the optimum's neighbours again, on all ranks. Collective; the lines are the same on
/// all ranks.
std::vector<std::string> warnings(const Job& job, const Lattice& lattice, const Summary& summary,
                                  MPI_Comm comm);

}  // namespace trebsweep
