#pragma once

#include <mpi.h>

#include <functional>
#include <string>
#include <vector>

#include "trebsweep/archive/summary.hpp"
#include "trebsweep/job/job.hpp"
#include "trebsweep/job/lattice.hpp"

namespace trebsweep {

/// What makes the result of a complete sweep doubtful, a line for each cause: designs with an
/// efficiency above 1, designs whose status or speed a fixed step changes, an optimum on the edge
/// of the lattice, and slings that would go slack among the best designs. Integrates the optimum's
/// neighbours and a sample of the lattice again, on all ranks, as far as a second allows and `stop`
/// does not end it. Collective; the lines are the same on all ranks.
std::vector<std::string> warnings(const Job& job, const Lattice& lattice, const Summary& summary,
                                  const std::function<bool()>& stop, MPI_Comm comm);

}  // namespace trebsweep
