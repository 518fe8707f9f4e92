#pragma once

#include <vector>

#include "trebsweep/job/lattice.hpp"

namespace trebsweep {

/// Every design of a lattice, in the order of its maps.
std::vector<Design<double>> all_designs(const Lattice& lattice);

/// Designs that stand for a lattice's: the corners of its box and of its triangle, and `count` more
/// by Sobol's low-discrepancy sequence; all of them, if there are no more than that.
std::vector<Design<double>> sample(const Lattice& lattice, std::size_t count);

}  // namespace trebsweep
