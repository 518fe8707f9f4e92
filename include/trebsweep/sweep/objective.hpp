#pragma once

#include <span>
#include <vector>

#include "trebsweep/job/job.hpp"

namespace trebsweep {

/// The fields that decide which design is the optimum: the objective, those of constraints, and
/// slack if only taut slings compete.
std::vector<Field> deciding_fields(const Job& job);

/// The objective of a design of a scene, in the unit of its field, from the values of its
/// deciding_fields(), which `values` begins with. NaN for a design that violates a constraint or
/// has no release, or whose sling goes slack if only taut ones compete.
double objective(std::span<const double> values, const Job& job, const Scene& scene,
                 const Design<double>& design);

}  // namespace trebsweep
