#include "trebsweep/job/sample.hpp"

#include <algorithm>
#include <set>
#include <tuple>

#include "support/catch.hpp"

using namespace trebsweep;

TEST_CASE("A sample holds the corners and as many other designs as requested, all different") {
  const Lattice lattice(Scene{}, LatticeSpec{});
  const auto designs = sample(lattice, 100);
  CHECK(designs.size() == 106);
  std::set<std::tuple<double, double, double>> distinct;
  for (const auto& [r1, r3, r2] : designs) {
    CHECK(r2 < 1.5 - r3 + 1e-9);
    distinct.emplace(r1, r3, r2);
  }
  CHECK(distinct.size() == designs.size());
  for (const auto& corner : {std::tuple(0.51, 0.3, 0.01), std::tuple(1.49, 0.3, 1.19),
                             std::tuple(0.51, 1.48, 0.01), std::tuple(1.49, 0.3, 0.01)})
    CHECK(distinct.count(corner) == 1);
}

TEST_CASE("A sample is spread evenly over the lattice") {
  const auto designs = sample(Lattice(Scene{}, LatticeSpec{}), 200);
  const auto below = std::count_if(designs.begin(), designs.end(),
                                   [](const Design<double>& d) { return d.r1 < 1; });
  CHECK(static_cast<double>(below) / static_cast<double>(designs.size()) ==
        Approx(0.5).margin(0.05));
}

TEST_CASE("A sample of a small lattice is the whole lattice") {
  LatticeSpec spec;
  spec.increment = 0.25;
  const Lattice lattice(Scene{}, spec);
  CHECK(sample(lattice, 1000).size() == lattice.designs());
  CHECK(all_designs(lattice).size() == lattice.designs());
}

TEST_CASE("A sample of a box lies within it and is as large as requested, if the box is") {
  const Lattice lattice(Scene{}, LatticeSpec{});
  const Block box{{10, 40, 60}, {7, 9, 80 - 60}};
  const auto indices = sample_box(lattice, box, 50);
  CHECK(std::set<Index3>(indices.begin(), indices.end()).size() == 50);
  for (const Index3& index : indices) {
    CHECK(lattice.holds(index));
    for (std::size_t d = 0; d < 3; ++d)
      CHECK((index[d] >= box.first[d] && index[d] < box.first[d] + box.count[d]));
  }
  CHECK(sample_box(lattice, box, 5000).size() == lattice.designs_in(box));
}
