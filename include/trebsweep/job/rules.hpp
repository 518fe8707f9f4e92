#pragma once

#include <map>
#include <string>

#include "trebsweep/job/job.hpp"

namespace trebsweep {

/// The keys that a job does not use, each with the reason, as the rest of a message: "left out
/// unless solver.release is window".
std::map<std::string, std::string> unused_keys(const Job& job);

/// Checks the rules across keys, whose values are each in their own range; `given` are the texts of
/// the keys that are not left at their defaults. Throws InputError if two keys contradict each
/// other, one requires another that is missing, or the job does not use one.
void check_rules(const Job& job, const std::map<std::string, std::string>& given);

}  // namespace trebsweep
