#pragma once

#include <vector>

#include "trebsweep/job/job.hpp"

namespace trebsweep {

/// The fields that decide which design is the optimum: those of the objective and of constraints,
/// and slack if only taut slings compete.
std::vector<Field> deciding_fields(const Job& job);

/// The objective of a design, in the unit of its expression, from its deciding_fields(). NaN for a
/// design that violates a constraint or has no release, or whose sling goes slack if only taut ones
/// compete.
double objective(const Operands& operands, const Job& job);

}  // namespace trebsweep
