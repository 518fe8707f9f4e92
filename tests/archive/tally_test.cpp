#include "trebsweep/archive/tally.hpp"

#include <algorithm>
#include <limits>
#include <span>

#include "support/catch.hpp"

using namespace trebsweep;

namespace {

constexpr double no_value = std::numeric_limits<double>::quiet_NaN();

bool is_same(const Tally& a, const Tally& b) {
  return std::ranges::equal(std::as_bytes(std::span(&a, 1)), std::as_bytes(std::span(&b, 1)));
}

}  // namespace

TEST_CASE("Tallies of parts add up to the tally of the whole") {
  Tally parts[3], whole, sum;
  for (std::uint64_t i = 0; i < 30; ++i) {
    // Equal objectives in all parts: the best design is the first in the lattice.
    const auto number = static_cast<double>(i), value = static_cast<double>(i % 5) - 9;
    const SwingResult result = i % 7 == 0 ? SwingResult{no_value, no_value, i, Status::not_released}
                                          : SwingResult{number, 2 * number, 10, Status::released};
    const double objective = i == 4 ? no_value : value;  // 4, one of the largest, does not compete
    const Design<double> design{1, number, 50 - number};
    parts[2 - i % 3].add(result, i, design, objective);
    whole.add(result, i, design, objective);
  }
  for (Tally* tally : {&parts[0], &parts[1], &whole}) tally->lane_steps += tally == &whole ? 8 : 4;
  for (const Tally& part : parts) sum.add(part);
  CHECK(is_same(sum, whole));
  CHECK(sum.designs() == 30);
  CHECK(sum.best.value == -5);
  CHECK(sum.best.design == Design<double>{1, 9, 41});
  CHECK(sum.best.speed == 9);
  CHECK(sum.best.release_time == 18);
  CHECK(sum.lane_steps == 8);
  CHECK(sum.first_cells[static_cast<std::size_t>(Status::released)] == 1);
  CHECK(sum.first_cells[static_cast<std::size_t>(Status::not_released)] == 0);
  CHECK(sum.first_cells[static_cast<std::size_t>(Status::non_finite)] == no_cell);
}

TEST_CASE("A design without a release, or without a finite objective, is not the best") {
  Tally tally;
  const Design<double> design{1, 2, 3};
  tally.add({99, 1, 1, Status::not_released}, 0, design, 99);
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double value : {no_value, infinity, -infinity})
    tally.add({99, 1, 1, Status::released}, 1, design, value);
  CHECK(tally.designs() == 4);
  CHECK_FALSE(tally.best.exists());
  tally.add({3, 1, 1, Status::released_below_ground}, 7, design, -1e300);
  CHECK(tally.best.design == design);
}
