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
  CHECK(sum.best_cell == 9);
  CHECK(sum.best_value == -5);
  CHECK(sum.best_speed == 9);
  CHECK(sum.best_time == 18);
  CHECK(sum.first_cells[static_cast<std::size_t>(Status::released)] == 1);
  CHECK(sum.first_cells[static_cast<std::size_t>(Status::not_released)] == 0);
  CHECK(sum.first_cells[static_cast<std::size_t>(Status::non_finite)] == no_cell);
  CHECK(to_tally(to_row(Tally{})).best_cell == no_cell);
}

TEST_CASE("A design without a release, or without a finite objective, is not the best") {
  Tally tally;
  tally.add({99, 1, 1, Status::not_released}, 0, 99);
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double value : {no_value, infinity, -infinity})
    tally.add({99, 1, 1, Status::released}, 1, value);
  CHECK(tally.designs() == 4);
  CHECK(tally.best_cell == no_cell);
  tally.add({3, 1, 1, Status::released_below_ground}, 7, -1e300);
  CHECK(tally.best_cell == 7);
}

TEST_CASE(
    "Older archives lack the objective and newer statuses, and the first ones the first cells") {
  const auto names = [](unsigned long long version) {
    std::vector<std::string_view> columns;
    for (const std::size_t c : stored_columns(version)) columns.push_back(tally_columns[c]);
    return columns;
  };
  CHECK(names(6) == std::vector<std::string_view>(tally_columns.begin(), tally_columns.end()));
  auto five = names(6);
  std::erase(five, "best_value");
  CHECK(names(5) == five);
  const auto four = names(4), three = names(3);
  CHECK(four.size() == 23);
  CHECK(four[7] == "released_below_ground");
  CHECK(four[8] == "steps");
  CHECK(four.back() == "first_released_below_ground");
  CHECK(three == std::vector<std::string_view>(four.begin(), four.begin() + 15));
}

TEST_CASE("In older archives the objective is the speed, and -1 where nothing was released") {
  const auto best_of = [](double speed, double cell) {
    const auto columns = stored_columns(5);
    std::vector<double> stored(columns.size(), 1);
    const auto set = [&](std::string_view name, double value) {
      for (std::size_t c = 0; c < columns.size(); ++c)
        if (tally_columns[columns[c]] == name) stored[c] = value;
    };
    set("best_speed", speed);
    set("best_cell", cell);
    return to_tally(to_current_row(stored, 5));
  };
  CHECK(best_of(17, 3).best_value == 17);
  CHECK(best_of(0, 3).best_value == 0);
  Tally sum;
  sum.add(best_of(-1, -1));
  CHECK(sum.best_value == Tally{}.best_value);
  CHECK(sum.best_cell == no_cell);
}

TEST_CASE("Rows with invalid counts are refused") {
  for (const double bad : {-1.0, 1e17, no_value}) {
    TallyRow row{};
    row[1] = bad;
    CHECK_THROWS_AS(to_tally(row), std::runtime_error);
  }
}
