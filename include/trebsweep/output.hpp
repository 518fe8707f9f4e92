#pragma once

#include "trebsweep/job.hpp"

namespace trebsweep {

/// Makes sure, before anything is computed, that the job's archive can be written, by creating its
/// partial file. Returns false, and creates nothing, where the complete archive of this very job is
/// there already. For one rank alone. `overwrite` allows to replace an archive, or a partial one,
/// but no other file. Throws InputError where the place cannot be written or holds something else.
bool prepare_output(const Job& job, bool overwrite);

}  // namespace trebsweep
