#pragma once

#include <vector>

#include "trebsweep/job/lattice.hpp"

namespace trebsweep {

/// Every design of a lattice, in storage order.
std::vector<Design<double>> all_designs(const Lattice& lattice);

/// Representative designs of a lattice: the corners of its triangular prism, and `count` more taken
/// from Sobol's low-discrepancy sequence. All designs, if the lattice has no more than that.
std::vector<Design<double>> sample(const Lattice& lattice, std::size_t count);

}  // namespace trebsweep
