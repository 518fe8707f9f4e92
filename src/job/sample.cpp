#include "trebsweep/job/sample.hpp"

#include <boost/random/sobol.hpp>
#include <set>

namespace trebsweep {
namespace {

/// The corners of the triangular prism of designs; fewer than six if it is thin.
std::set<Index3> corners(const Lattice& lattice) {
  const Index3 extent = lattice.extent();
  std::size_t last3 = extent[1] - 1;
  while (last3 > 0 && !lattice.holds({0, last3, 0})) --last3;
  std::set<Index3> indices;
  for (const std::size_t i1 : {std::size_t{0}, extent[0] - 1})
    for (const std::size_t i3 : {std::size_t{0}, last3})
      for (const std::size_t i2 : {std::size_t{0}, lattice.row_length(i3) - 1})
        indices.insert({i1, i3, i2});
  return indices;
}

}  // namespace

std::vector<Design<double>> all_designs(const Lattice& lattice) {
  const Index3 extent = lattice.extent();
  std::vector<Design<double>> designs;
  for (std::size_t i1 = 0; i1 < extent[0]; ++i1)
    for (std::size_t i3 = 0; i3 < extent[1]; ++i3)
      for (std::size_t i2 = 0; i2 < extent[2] && lattice.holds({i1, i3, i2}); ++i2)
        designs.push_back(lattice.design({i1, i3, i2}));
  return designs;
}

std::vector<Design<double>> sample(const Lattice& lattice, std::size_t count) {
  const Index3 extent = lattice.extent();
  std::set<Index3> indices = corners(lattice);
  const std::size_t wanted = indices.size() + count;
  if (lattice.designs() <= wanted) return all_designs(lattice);
  boost::random::sobol sequence(3);
  const double range = static_cast<double>(sequence.max()) + 1;
  while (indices.size() < wanted) {
    Index3 index;
    for (std::size_t d = 0; d < 3; ++d)
      index[d] = static_cast<std::size_t>(static_cast<double>(sequence()) / range *
                                          static_cast<double>(extent[d]));
    if (lattice.holds(index)) indices.insert(index);
  }
  std::vector<Design<double>> designs;
  for (const Index3& index : indices) designs.push_back(lattice.design(index));
  return designs;
}

}  // namespace trebsweep
