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

/// The indices of all designs in a box, in storage order.
std::vector<Index3> indices_in(const Lattice& lattice, const Block& box) {
  std::vector<Index3> indices;
  for (std::size_t i1 = box.first[0]; i1 < box.first[0] + box.count[0]; ++i1)
    for (std::size_t i3 = box.first[1]; i3 < box.first[1] + box.count[1]; ++i3)
      for (std::size_t i2 = box.first[2]; i2 < box.first[2] + box.count[2]; ++i2)
        if (lattice.holds({i1, i3, i2})) indices.push_back({i1, i3, i2});
  return indices;
}

/// `given` and `count` more designs of a box; all designs of the box if it has no more than that.
std::vector<Index3> with_sobol(std::set<Index3> given, std::size_t count, const Lattice& lattice,
                               const Block& box) {
  const std::size_t wanted = given.size() + count;
  if (lattice.designs_in(box) <= wanted) return indices_in(lattice, box);
  boost::random::sobol sequence(3);
  const double range = static_cast<double>(sequence.max()) + 1;
  while (given.size() < wanted) {
    Index3 index;
    for (std::size_t d = 0; d < 3; ++d)
      index[d] = box.first[d] + static_cast<std::size_t>(static_cast<double>(sequence()) / range *
                                                         static_cast<double>(box.count[d]));
    if (lattice.holds(index)) given.insert(index);
  }
  return {given.begin(), given.end()};
}

Block whole(const Lattice& lattice) { return {{0, 0, 0}, lattice.extent()}; }

}  // namespace

std::vector<Design<double>> designs_at(std::span<const Index3> indices, const Lattice& lattice) {
  std::vector<Design<double>> designs;
  for (const Index3& index : indices) designs.push_back(lattice.design(index));
  return designs;
}

std::vector<Design<double>> all_designs(const Lattice& lattice) {
  return designs_at(indices_in(lattice, whole(lattice)), lattice);
}

std::vector<Index3> sample_box(const Lattice& lattice, const Block& box, std::size_t count) {
  return with_sobol({}, count, lattice, box);
}

std::vector<Index3> sample_indices(const Lattice& lattice, std::size_t count) {
  return with_sobol(corners(lattice), count, lattice, whole(lattice));
}

std::vector<Design<double>> every(std::size_t n, std::size_t first,
                                  std::span<const Design<double>> designs) {
  std::vector<Design<double>> part;
  for (std::size_t i = first; i < designs.size(); i += n) part.push_back(designs[i]);
  return part;
}

std::vector<Design<double>> sample(const Lattice& lattice, std::size_t count) {
  return designs_at(sample_indices(lattice, count), lattice);
}

}  // namespace trebsweep
