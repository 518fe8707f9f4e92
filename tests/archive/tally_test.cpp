#include "trebsweep/archive/tally.hpp"

#include <limits>
#include <stdexcept>

#include "support/catch.hpp"

using namespace trebsweep;

namespace {

constexpr double no_value = std::numeric_limits<double>::quiet_NaN();

}  // namespace

TEST_CASE("Tallies of parts, stored and read back, add up to the tally of the whole") {
  Tally parts[3], whole, sum;
  for (std::uint64_t i = 0; i < 30; ++i) {
    // Equal objectives in all parts: the best design is the one with the lowest index.
    const auto number = static_cast<double>(i), value = static_cast<double>(i % 5) - 9;
    const SwingResult result = i % 7 == 0 ? SwingResult{no_value, no_value, i, Status::not_released}
                                          : SwingResult{number, 2 * number, 10, Status::released};
    const double objective = i == 4 ? no_value : value;  // 4, one of the largest, does not compete
    parts[2 - i % 3].add(result, i, objective);
    whole.add(result, i, objective);
  }
  for (const Tally& part : parts) sum.add(to_tally(to_row(part)));
  CHECK(to_row(sum) == to_row(whole));
  CHECK(sum.best.cell == 9);
  CHECK(sum.best.value == -5);
  CHECK(sum.best.speed == 9);
  CHECK(sum.best.release_time == 18);
  CHECK(sum.first_cells[static_cast<std::size_t>(Status::released)] == 1);
  CHECK(sum.first_cells[static_cast<std::size_t>(Status::not_released)] == 0);
  CHECK(sum.first_cells[static_cast<std::size_t>(Status::non_finite)] == no_cell);
  CHECK(to_tally(to_row(Tally{})).best.cell == no_cell);
}

TEST_CASE("A design without a release, or without a finite objective, is not the best") {
  Tally tally;
  tally.add({99, 1, 1, Status::not_released}, 0, 99);
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double value : {no_value, infinity, -infinity})
    tally.add({99, 1, 1, Status::released}, 1, value);
  CHECK(tally.designs() == 4);
  CHECK(tally.best.cell == no_cell);
  tally.add({3, 1, 1, Status::released_below_ground}, 7, -1e300);
  CHECK(tally.best.cell == 7);
}

TEST_CASE("Rows with invalid counts are refused") {
  for (const double bad : {-1.0, 1e17, no_value}) {
    TallyRow row{};
    row[1] = bad;
    CHECK_THROWS_AS(to_tally(row), std::runtime_error);
  }
}
