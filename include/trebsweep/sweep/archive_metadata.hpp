#pragma once

#include <string>
#include <vector>

#include "trebsweep/archive/archive_format.hpp"
#include "trebsweep/archive/summary.hpp"
#include "trebsweep/job/job.hpp"

namespace trebsweep {

/// The value of a map in cells outside the lattice: 0 for flags, else NaN.
double fill_value(Field field);

/// How the archive stores and describes the job's maps, in the order of its fields.
std::vector<MapInfo> map_infos(const Output& output);

/// The root attributes of a new archive. The result_attributes() are included with placeholders,
/// which the complete sweep overwrites. `replaces` is the file_identity() of the archive that it
/// will replace, or empty.
Attributes root_attributes(const Job& job, const std::string& history, const std::string& replaces);

/// The root attributes that hold the results of a sweep. Those of the optimum and of the measured
/// error are NaN without an optimum, or if nothing was measured.
Attributes result_attributes(const Summary& summary);

}  // namespace trebsweep
