#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "trebsweep/job/job.hpp"
#include "trebsweep/optimum/swing_parts.hpp"

namespace trebsweep {

/// How an optimum depends on a numeric key of the scene.
struct Sensitivity {
  double value;       ///< of the key
  double at_design;   ///< d objective / d key, the parameters as they are; NaN at a kink
  double of_optimum;  ///< d optimum / d key, the parameters optimal again; NaN of a robust optimum,
                      ///< or without multipliers
};

/// The numeric keys of the scene whose derivatives exist: those in use, except variables, and
/// lengths and stiffnesses that are 0 because the scene lacks their effect. In the order of
/// job_keys().
std::vector<std::string> numeric_scene_keys(const Job& job);

/// The sensitivity to a key at an optimum, whose variables the job's scene has, from the parts of
/// its swing. A key that is 0 and cannot be negative has a one-sided derivative. (The derivative of
/// the optimum follows from the envelope theorem.)
Sensitivity sensitivity(const Job& job, const std::string& key, const Parameters& parameters,
                        const std::vector<PartOptimum>& parts);

}  // namespace trebsweep
