#pragma once

#include <mpi.h>

#include <functional>
#include <optional>
#include <vector>

#include "trebsweep/archive/summary.hpp"
#include "trebsweep/job/buildable.hpp"
#include "trebsweep/job/study.hpp"

namespace trebsweep {

/// The best design of a scene, between those of its lattice if it was refined, and what decides
/// whether it can be built. All zero if the scene has none.
struct BestDesign {
  Design<double> design;
  BuildValues build;

  bool exists() const { return design.r1 > 0; }
};

/// The best design of each scene of a complete sweep, integrated by the job's solver or, with
/// optimum.refine, accurately, as the search does. Of the summary only rank 0's is used.
/// Collective; the same on all ranks. Returns nothing once `stop` is true on any rank.
std::optional<std::vector<BestDesign>> best_designs(const Study& study, const Summary& summary,
                                                    const std::function<bool()>& stop,
                                                    MPI_Comm comm);

}  // namespace trebsweep
