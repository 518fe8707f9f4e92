#pragma once

#include <mpi.h>

#include <cstdint>
#include <string>

#include "trebsweep/job/job.hpp"

namespace trebsweep {

/// What an assessment will cost, as far as it is known before.
struct AssessmentCost {
  std::uint64_t scenes, designs;  ///< designs of all scenes
  std::uint64_t settings;         ///< of steppers, over all scenes
  double reference_seconds;       ///< processor time of the references, s
  double setting_seconds;         ///< processor time to measure the settings, s
};

/// Times a reference in each scene and some of the settings, shared among the ranks. `own` names
/// the job's own scene. Writes nothing. Collective. Throws InputError as assess() does.
AssessmentCost assessment_cost(const Job& job, bool overwrite, const std::string& own,
                               MPI_Comm comm);

}  // namespace trebsweep
