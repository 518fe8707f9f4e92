#include "trebsweep/archive/tally.hpp"

#include <cmath>
#include <stdexcept>

#include "support/catch.hpp"

using namespace trebsweep;

TEST_CASE("Tallies of parts, stored and read back, add up to the tally of the whole") {
  Tally parts[3], whole, sum;
  for (std::uint64_t i = 0; i < 30; ++i) {
    // Equal speeds in all parts: the best design is the one with the lowest index.
    const auto speed = static_cast<double>(i % 5), time = static_cast<double>(i);
    const SwingResult result = i % 7 == 0 ? SwingResult{0, 0, i, Status::not_released}
                                          : SwingResult{speed, time, 10, Status::released};
    parts[2 - i % 3].add(result, i, i != 4);
    whole.add(result, i, i != 4);
  }
  for (const Tally& part : parts) sum.add(to_tally(to_row(part)));
  CHECK(to_row(sum) == to_row(whole));
  CHECK(sum.best_cell == whole.best_cell);
  CHECK(sum.first_cells[static_cast<std::size_t>(Status::released)] == 1);
  CHECK(sum.first_cells[static_cast<std::size_t>(Status::not_released)] == 0);
  CHECK(sum.first_cells[static_cast<std::size_t>(Status::non_finite)] == no_cell);
  CHECK(to_tally(to_row(Tally{})).best_cell == Tally{}.best_cell);
}

TEST_CASE(
    "Older archives lack the columns of newer statuses, and the first ones those of first cells") {
  const auto names = [](unsigned long long version) {
    std::vector<std::string_view> columns;
    for (const std::size_t c : stored_columns(version)) columns.push_back(tally_columns[c]);
    return columns;
  };
  CHECK(names(5) == std::vector<std::string_view>(tally_columns.begin(), tally_columns.end()));
  const auto four = names(4), three = names(3);
  CHECK(four.size() == 23);
  CHECK(four[7] == "released_below_ground");
  CHECK(four[8] == "steps");
  CHECK(four.back() == "first_released_below_ground");
  CHECK(three == std::vector<std::string_view>(four.begin(), four.begin() + 15));
}

TEST_CASE("Rows with invalid counts are refused") {
  for (const double bad : {-1.0, 1e17, std::nan("")}) {
    TallyRow row{};
    row[1] = bad;
    CHECK_THROWS_AS(to_tally(row), std::runtime_error);
  }
}
