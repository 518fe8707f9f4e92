#pragma once

#include <mpi.h>

#include <functional>
#include <string>
#include <vector>

#include "trebsweep/archive/summary.hpp"
#include "trebsweep/job/job.hpp"
#include "trebsweep/job/lattice.hpp"

namespace trebsweep {

/// Reasons to doubt the result of a complete sweep, a line for each: an optimum on the edge of the
/// lattice, designs whose status or speed changes when they are integrated accurately, designs with
/// an efficiency above 1, and designs close to the optimum whose sling would go slack. Integrates
/// the optimum's neighbours and a sample of the lattice again on all ranks, for at most about a
/// second or until `stop` is true. Collective; the lines are the same on all ranks.
std::vector<std::string> warnings(const Job& job, const Lattice& lattice, const Summary& summary,
                                  const std::function<bool()>& stop, MPI_Comm comm);

}  // namespace trebsweep
