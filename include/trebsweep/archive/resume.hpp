#pragma once

#include <filesystem>
#include <string>

#include "trebsweep/archive/partial.hpp"
#include "trebsweep/job/job.hpp"

namespace trebsweep {

/// Whether the text of a job file that a sweep stored is that of a job with the same results.
bool is_same_job(const Job& job, const std::string& stored);

/// Throws InputError if a partial sweep belongs to another job than `job`, and std::runtime_error
/// if it was started with another version of the numerics or another kind of floating-point
/// arithmetic: its maps would differ from those of an uninterrupted sweep.
void require_resumable(const Job& job, const std::filesystem::path& folder,
                       const PartialSweep& partial);

}  // namespace trebsweep
