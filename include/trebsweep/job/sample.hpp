#pragma once

#include <span>
#include <vector>

#include "trebsweep/job/lattice.hpp"

namespace trebsweep {

/// Every design of a lattice, in storage order.
std::vector<Design<double>> all_designs(const Lattice& lattice);

/// The indices of `count` designs in a box of the lattice, taken from Sobol's low-discrepancy
/// sequence; of all designs in it, if there are no more. In storage order.
std::vector<Index3> sample_box(const Lattice& lattice, const Block& box, std::size_t count);

/// The indices of representative designs of a lattice: the corners of its triangular prism, and
/// `count` more from Sobol's sequence. Of all designs, if the lattice has no more than that.
std::vector<Index3> sample_indices(const Lattice& lattice, std::size_t count);

/// The designs with some indices.
std::vector<Design<double>> designs_at(std::span<const Index3> indices, const Lattice& lattice);

/// The designs of sample_indices().
std::vector<Design<double>> sample(const Lattice& lattice, std::size_t count);

/// Every n-th of some designs, beginning with a number: a part of a sample that is representative.
std::vector<Design<double>> every(std::size_t n, std::size_t first,
                                  std::span<const Design<double>> designs);

}  // namespace trebsweep
