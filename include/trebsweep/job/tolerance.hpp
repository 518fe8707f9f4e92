#pragma once

#include "trebsweep/job/job.hpp"

namespace trebsweep {

/// The loosest tolerance with which the job's stepper keeps the error of the speed within a quarter
/// of the solver's target error on a sample of the lattice; the factor covers the designs that are
/// not sampled. Errors are differences from dopri5 at a tolerance of 1e-14. Throws InputError if no
/// tolerance meets the target.
double tolerance_for_target(const Job& job);

}  // namespace trebsweep
