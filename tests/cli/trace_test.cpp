#include "trebsweep/cli/trace.hpp"

#include <cstdio>
#include <map>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/paper_solver.hpp"
#include "trebsweep/base/error.hpp"

using namespace trebsweep;

namespace {

constexpr Design<double> optimum{0.51, 0.58, 0.91};

struct Table {
  std::vector<std::string> comments;
  std::string header;
  std::vector<std::map<std::string, double>> rows;
  Status status;
};

/// A trace, read back from what it printed.
Table read_trace(const Job& job, std::optional<double> interval = {}) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::tmpfile(), &std::fclose);
  Table table;
  table.status = trace(job, optimum, interval, file.get());
  std::string text(static_cast<std::size_t>(std::ftell(file.get())), '\0');
  std::rewind(file.get());
  REQUIRE(std::fread(text.data(), 1, text.size(), file.get()) == text.size());

  std::istringstream lines(text);
  while (std::getline(lines, table.header) && table.header.starts_with('#'))
    table.comments.push_back(table.header);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream names(table.header), values(line);
    std::map<std::string, double> row;
    std::string name;
    for (double value; names >> name && values >> value;) row[name] = value;
    table.rows.push_back(row);
  }
  return table;
}

Job paper() {
  Job job;
  job.solver = paper_solver();
  return job;
}

Job accurate() {
  Job job;
  job.solver.stepper = "dopri5";
  return job;
}

}  // namespace

TEST_CASE(
    "A trace starts with comments on gravity, fulcrum and release, then the header t phi1 phi2 "
    "...") {
  const Table table = read_trace(paper());
  CHECK(table.header.starts_with("t phi1 phi2 "));
  CHECK(table.comments == std::vector<std::string>{"# gravity = 9.8", "# fulcrum-height = 1.5",
                                                   "# release = window",
                                                   "# release-window = 0.05"});
  CHECK(read_trace(accurate()).comments.back() == "# release = crossing");
}

TEST_CASE("A trace of euler has one row per step, from the start to the paper's release") {
  const Table table = read_trace(paper());
  REQUIRE(table.rows.size() == 93);
  for (std::size_t i = 0; i < table.rows.size(); ++i)
    CHECK(table.rows[i].at("t") == Approx(0.01 * static_cast<double>(i)));
  CHECK(table.rows.back().at("speed") == Approx(17.47606519).margin(5e-9));
}

TEST_CASE("A trace of an adaptive method has rows at equal intervals and ends at the release") {
  const Table table = read_trace(accurate(), 0.1);
  REQUIRE(table.rows.size() == 11);
  CHECK(table.rows.at(3).at("t") == Approx(0.3));
  CHECK(table.rows.back().at("t") == Approx(0.9070885913).margin(1e-9));
  CHECK(read_trace(accurate()).rows.size() == 92);  // every 0.01 s by itself
}

TEST_CASE("Rows between two steps of euler are interpolated linearly, up to the release") {
  const Table steps = read_trace(paper()), halves = read_trace(paper(), 0.005);
  REQUIRE(halves.rows.size() == 2 * steps.rows.size() - 1);
  for (std::size_t i = 0; i < halves.rows.size(); ++i)
    for (const std::string name : {"t", "phi1", "phi2", "w1", "w2"}) {
      const double before = steps.rows[i / 2].at(name), after = steps.rows[(i + 1) / 2].at(name);
      CHECK(halves.rows[i].at(name) == Approx((before + after) / 2).margin(1e-9));
    }
}

TEST_CASE("Rows between steps are as accurate as the steps") {
  Job job = accurate(), fine = accurate();
  job.solver.tolerance = 1e-9;
  fine.solver.tolerance = 1e-13;
  const Table rows = read_trace(job, 0.003), truth = read_trace(fine, 0.003);
  REQUIRE(rows.rows.size() == truth.rows.size());
  for (std::size_t i = 0; i < rows.rows.size(); ++i)
    for (const auto& [name, value] : truth.rows[i])
      CHECK(rows.rows[i].at(name) == Approx(value).epsilon(2e-8).margin(2e-8));
}

TEST_CASE("The sling's tension grows from 1.04 kN at rest to 23.0 kN at release") {
  const Table table = read_trace(accurate());
  CHECK(table.rows.front().at("tension") == Approx(1040).margin(5));
  CHECK(table.rows.back().at("tension") == Approx(23000).margin(50));
  for (const auto& row : table.rows) CHECK(row.at("tension") > 0);
}

TEST_CASE("A swing without a release is traced to its time limit") {
  Job job = accurate();
  job.solver.max_time = 0.255;
  const Table table = read_trace(job);
  CHECK(table.status == Status::not_released);
  CHECK(table.rows.back().at("t") == 0.255);
}

TEST_CASE("A design without an initial state is an error") {
  CHECK_THROWS_WITH(trace(paper(), {0.4, 1, 1}, {}, stderr),
                    contains("r1 = 0.4: must be at least"));
}

TEST_CASE("An interval that would print millions of rows is an error") {
  CHECK_THROWS_WITH(trace(accurate(), optimum, 1e-300, stderr), contains("interval = 1e-300"));
}
