#pragma once

#include <mpi.h>

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "trebsweep/archive/summary.hpp"
#include "trebsweep/base/progress.hpp"
#include "trebsweep/job/study.hpp"
#include "trebsweep/sweep/measured_error.hpp"
#include "trebsweep/sweep/scene_optima.hpp"

namespace trebsweep {

/// Options that do not change the results of a sweep.
struct SweepOptions {
  bool overwrite = false;  ///< replace an existing archive or unfinished sweep
  ProgressStyle progress = ProgressStyle::automatic;
  std::string command;                   ///< the command line, for the archive's history
  std::optional<Index3> tile_edge = {};  ///< largest extent of a tile; chosen if not given
  Refine refine = {};                    ///< for jobs with optimum.refine
  std::function<bool()> stop = [] { return false; };  ///< polled on every rank
};

struct SweepResult {
  Summary summary;
  std::vector<ErrorSample> samples;  ///< of a complete sweep with solver.check
};

/// Refuses to mix ranks with and without fused multiply-add, whose results differ in the last
/// digits. `instruction_set` is that of this rank's kernel. Collective. Throws mpi::RootError on
/// all ranks.
void check_arithmetic(std::string_view instruction_set, MPI_Comm comm);

/// Integrates every design of the lattice in every scene, measures the error of the speeds, and
/// writes the archive; continues an interrupted sweep of the same job. Collective; the result of a
/// complete sweep is the same on all ranks. Returns nothing if the complete archive of this job
/// already exists. If `stop` is true on any rank, all ranks stop after the tiles that they have
/// begun, which their journals keep. Throws, on all ranks, InputError if the path of the archive is
/// invalid, and mpi::RootError if an archive cannot be created or an unfinished sweep cannot be
/// continued.
std::optional<SweepResult> sweep(const Study& study, const SweepOptions& options, MPI_Comm comm);

}  // namespace trebsweep
