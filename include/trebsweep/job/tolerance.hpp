#pragma once

#include "trebsweep/job/job.hpp"

namespace trebsweep {

/// The loosest tolerance with which the job's stepper keeps the speeds of a sample of the lattice
/// within a quarter of the solver's target error: the sample is not the whole lattice. Held against
/// dopri5 at a tolerance of 1e-14. Throws InputError where no tolerance reaches it.
double tolerance_for_target(const Job& job);

}  // namespace trebsweep
