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

/// The root attributes of an archive. Those of the optimum and of the measured error are NaN
/// without an optimum, or if nothing was measured.
Attributes root_attributes(const Job& job, const std::string& history, const Summary& summary);

}  // namespace trebsweep
