#include "trebsweep/cli/trace.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/machines.hpp"
#include "support/paper_solver.hpp"
#include "trebsweep/base/error.hpp"
#include "trebsweep/cli/help.hpp"
#include "trebsweep/swing/flight.hpp"
#include "trebsweep/swing/integrate.hpp"

using namespace trebsweep;

namespace {

constexpr Design<double> laboratory_machine{0.25, 0.87, 0.975};

struct Table {
  std::vector<std::string> comments;
  std::string header;
  std::vector<std::map<std::string, double>> rows;
  Status status;
  std::string problems;
};

/// What trace() or trace_flight() printed, read back.
Table read_trace(const Job& job, std::optional<double> interval = {},
                 const Design<double>& design = paper_optimum, decltype(trace)* print = trace) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::tmpfile(), &std::fclose);
  Table table;
  const auto [status, problems] = print(job, design, interval, file.get());
  table.status = status;
  table.problems = to_text(problems);
  std::string text(static_cast<std::size_t>(std::ftell(file.get())), '\0');
  std::rewind(file.get());
  REQUIRE(std::fread(text.data(), 1, text.size(), file.get()) == text.size());

  std::istringstream lines(text);
  while (std::getline(lines, table.header) && table.header.starts_with('#'))
    table.comments.push_back(table.header);
  for (std::string line; std::getline(lines, line);) {
    REQUIRE(line[0] != '#');
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

/// The laboratory machine of arXiv:2502.19442.
Job laboratory() {
  Job job;
  job.scene = {.gravity = 9.81,
               .counterweight_mass = 53.9,
               .projectile_mass = 0.717,
               .fulcrum_height = 0.831,
               .beam_mass = 4.86,
               .beam_centre = 0.465,
               .beam_moment = 1.85,
               .start_angle = 0.55,
               .counterweight_hanger = 0.515,
               .trough = true};
  job.solver.tolerance = 1e-11;
  job.solver.release = Release::farthest;
  return job;
}

Job laboratory_with_drag() {
  Job job = laboratory();
  job.scene.projectile_diameter = 0.07;
  job.scene.wind = -3;
  return job;
}

Table laboratory_trace(std::optional<double> interval = {}) {
  return read_trace(laboratory(), interval, laboratory_machine);
}

Table read_flight(const Job& job, std::optional<double> interval = {}) {
  return read_trace(job, interval, laboratory_machine, trace_flight);
}

/// The number in a comment; NaN without it.
double comment(const Table& table, const std::string& key) {
  for (const std::string& line : table.comments)
    if (line.starts_with("# " + key + " = ")) return std::stod(line.substr(key.size() + 5));
  return NAN;
}

/// The second derivative of a column at row i, from three rows at equal intervals.
double acceleration(const Table& table, std::size_t i, const std::string& column, double interval) {
  const auto value = [&](std::size_t row) { return table.rows.at(row).at(column); };
  return (value(i + 1) - 2 * value(i) + value(i - 1)) / (interval * interval);
}

}  // namespace

TEST_CASE("A trace starts with comments on fulcrum and release, then the header t phi1 phi2 ...") {
  const Table table = read_trace(paper());
  CHECK(table.header ==
        "t phi1 phi2 w1 w2 x1 y1 xt yt x3 y3 speed energy tension tip_tension axle stress");
  REQUIRE(table.comments.size() == 9);
  CHECK(std::vector(table.comments.begin(), table.comments.begin() + 4) ==
        std::vector<std::string>{"# fulcrum-height = 1.5", "# release = window",
                                 "# release-window = 0.05", "# release-time = 0.92"});
  Job job = accurate();
  CHECK(comment(read_trace(job), "release-angle") == job.solver.release_angle);
  CHECK(comment(read_trace(job), "release-time") == Approx(0.9070885913).margin(1e-9));
  job.solver.release = Release::pin;
  job.solver.pin_angle = 0.6;
  CHECK(comment(read_trace(job), "pin-angle") == 0.6);
}

TEST_CASE("Hanger and trough add columns; the stress of a measured beam is left out") {
  CHECK(laboratory_trace().header ==
        "t phi1 phi2 w1 w2 phi3 w3 x1 y1 xh yh xt yt x3 y3 speed energy tension tip_tension axle "
        "hanger_tension normal");
}

TEST_CASE("The help of trace lists every column") {
  const std::string help = command_help(Command::trace);
  for (const Table& table :
       {read_trace(accurate()), laboratory_trace(), read_flight(laboratory())}) {
    std::istringstream names(table.header);
    for (std::string name; names >> name;) {
      INFO(name);
      // Alone, or as one of the names of a line.
      const auto listed = [&](const std::string& before, const std::string& after) {
        return help.find(before + name + after) != std::string::npos;
      };
      CHECK((listed("\n  ", " ") || listed("\n  ", "\n") || listed(" ", "  ")));
    }
  }
}

TEST_CASE("The projectile slides in the trough up to the lift-off, and is free afterwards") {
  const Table table = laboratory_trace();
  const double lift_off = comment(table, "lift-off-time");
  CHECK(lift_off == Approx(0.2532914651).margin(1e-9));
  for (const auto& row : table.rows) {
    INFO(row.at("t"));
    CHECK((row.at("normal") > 0) == (row.at("t") < lift_off));
    if (row.at("t") < lift_off)
      CHECK(row.at("y3") == Approx(-0.831).margin(1e-10));
    else
      CHECK(row.at("y3") > -0.831);
    CHECK(row.at("energy") == Approx(table.rows.front().at("energy")).epsilon(1e-9));
  }
  CHECK(table.rows.back().at("t") == Approx(0.574815).margin(1e-6));
}

TEST_CASE("The trough carries what is left of the projectile's weight by the sling") {
  const Scene scene = laboratory().scene;
  const Table table = laboratory_trace();
  for (const auto& row : table.rows) {
    if (row.at("normal") == 0) continue;
    const double up = (row.at("yt") - row.at("y3")) / laboratory_machine.r3;
    CHECK(row.at("normal") ==
          Approx(scene.projectile_mass * scene.gravity - up * row.at("tension")).epsilon(1e-9));
  }
}

TEST_CASE("The counterweight hangs from the hinge, which pulls it by the tension of the hanger") {
  const Scene scene = laboratory().scene;
  constexpr double interval = 1e-3;
  const Table table = laboratory_trace(interval);
  for (std::size_t i = 1; i + 2 < table.rows.size(); ++i) {
    const auto& row = table.rows[i];
    CHECK(std::hypot(row.at("xh"), row.at("yh")) == Approx(laboratory_machine.r1));
    CHECK(row.at("xh") - row.at("x1") ==
          Approx(scene.counterweight_hanger * std::sin(row.at("phi3"))).margin(1e-9));
    CHECK(row.at("yh") - row.at("y1") ==
          Approx(scene.counterweight_hanger * std::cos(row.at("phi3"))).margin(1e-9));
    const double upward = acceleration(table, i, "y1", interval) + scene.gravity;
    const double pull = scene.counterweight_mass *
                        (std::sin(row.at("phi3")) * acceleration(table, i, "x1", interval) +
                         std::cos(row.at("phi3")) * upward);
    CHECK(row.at("hanger_tension") == Approx(pull).epsilon(1e-3));
  }
}

namespace {

/// A machine whose arm and hanger are too long for its height.
Job sunken() {
  Job job;
  job.scene.counterweight_mass = 60;
  job.scene.projectile_mass = 0.5;
  job.scene.fulcrum_height = 1.1;
  job.scene.beam_side = 0.05;
  job.scene.beam_density = 700;
  job.scene.start_angle = 0.5;
  job.scene.counterweight_hanger = 0.6;
  job.scene.trough = true;
  job.solver.release = Release::fastest;
  return job;
}
constexpr Design<double> sunken_machine{0.9, 1, 2};

/// The least value of f(row), and its time.
template <class F>
std::pair<double, double> least(const Table& table, F f) {
  std::pair<double, double> found{INFINITY, NAN};
  for (const auto& row : table.rows)
    if (f(row) < found.first) found = {f(row), row.at("t")};
  return found;
}

/// The number of a comment and of that about its time.
std::pair<double, double> commented(const Table& table, const std::string& key) {
  return {comment(table, key), comment(table, key + "-time")};
}

/// Checks the least heights and tensions in the comments against the rows.
void check_least(const Job& job, const Design<double>& design, double size = 1) {
  constexpr double interval = 5e-5;
  const Table table = read_trace(job, interval, design);
  const auto close = [&](const std::string& key, const auto& expected, double allowed) {
    INFO(key << " of a swing until " << table.rows.back().at("t") << " s");
    const auto [value, time] = commented(table, key);
    CHECK(value == Approx(expected.first).margin(allowed));
    CHECK(time == Approx(expected.second).margin(1e-4));
  };
  const auto column = [](const std::string& name) {
    return [name](const auto& row) { return row.at(name); };
  };
  const double lift_off = comment(table, "lift-off-time");
  std::map<std::string, std::pair<double, double>> bodies{
      {"tip", least(table, column("yt"))}, {"counterweight", least(table, column("y1"))}};
  bodies["projectile"] = least(table, [&](const auto& row) {
    return job.scene.trough && !(row.at("t") >= lift_off) ? INFINITY : row.at("y3");
  });
  std::string lowest = "tip";
  for (const auto& [body, height] : bodies)
    if (height.first < bodies[lowest].first) lowest = body;
  CHECK(std::ranges::count(table.comments, "# ground-clearance-of = " + lowest) == 1);
  auto height = bodies[lowest];
  height.first += job.scene.fulcrum_height;
  close("ground-clearance", height, 1e-6);
  close("least-sling-tension", least(table, column("tension")), 2e-5 * size);
  if (job.scene.counterweight_hanger > 0)
    close("least-hanger-tension", least(table, column("hanger_tension")), 2e-5 * size);
  else
    CHECK(std::isnan(comment(table, "least-hanger-tension")));
}

}  // namespace

TEST_CASE("The comments say where and when heights and tensions of the rows are least", "[slow]") {
  Job job = sunken();
  check_least(job, sunken_machine, 1000);
  job.scene.start_angle = 0.99;
  check_least(job, sunken_machine, 1000);  // the counterweight is lowest
  job.solver.stepper = "rk4";
  job.solver.time_step = 0.002;
  check_least(job, sunken_machine, 1000);
  job.solver.max_time = 0.7;
  job.solver.release = Release::crossing;
  check_least(job, sunken_machine, 1000);  // without a release
  check_least(laboratory(), laboratory_machine, 1000);
  check_least(accurate(), paper_optimum, 1000);
  check_least(paper(), paper_optimum, 1000);
}

TEST_CASE("The least values of a trace are those of the fields") {
  const auto check = [](Job job, const Design<double>& design) {
    job.solver.tolerance = 1e-11;
    constexpr std::array fields{Field::ground_clearance, Field::least_sling_tension,
                                Field::least_hanger_tension};
    SwingResult result;
    std::array<double, 3> values;
    integrate(job.scene, job.solver, {{&design, 1}, {&result, 1}, fields, values});
    const Table table = read_trace(job, {}, design);
    for (std::size_t f = 0; f < 3; ++f)
      if (f < 2 || job.scene.counterweight_hanger > 0)
        CHECK(comment(table, std::string(info(fields[f]).name)) ==
              Approx(values[f]).epsilon(1e-8).margin(1e-6));
  };
  Job elastic = accurate();
  elastic.scene.sling_stiffness = 1e5;
  check(sunken(), sunken_machine);
  check(laboratory(), laboratory_machine);
  check(paper(), paper_optimum);
  check(elastic, paper_optimum);
}

TEST_CASE("A projectile on the ground, in the trough or just lifted off, is not under it") {
  for (const double max_time : {0.2, 10.0}) {  // before the lift-off, and after it
    Job job = laboratory();
    job.solver.max_time = max_time;
    Design<double> design = laboratory_machine;
    design.r2 = 0.9;  // the tip clears the ground
    const Table table = read_trace(job, {}, design);
    CHECK(table.problems == "");
    if (max_time < 1) {
      CHECK(comment(table, "ground-clearance") == Approx(0.831 - 0.9 * std::cos(0.55)));
      CHECK(std::ranges::count(table.comments, "# ground-clearance-of = tip") == 1);
    } else {
      CHECK(comment(table, "ground-clearance") == 0);
      CHECK(comment(table, "ground-clearance-time") == comment(table, "lift-off-time"));
      CHECK(std::ranges::count(table.comments, "# ground-clearance-of = projectile") == 1);
    }
  }
}

TEST_CASE("A trace says in what the machine cannot be built, also without a release") {
  Job job = sunken();
  const std::string problems = read_trace(job, {}, sunken_machine).problems;
  CHECK_THAT(problems,
             contains("the arm's tip reaches 0.66 m below the ground; the counterweight reaches "
                      "0.26 m below the ground; the sling goes slack: to stay straight, it would "
                      "have to push with 281 N; the counterweight's hanger is under a compression "
                      "of 3.2"));
  CHECK(read_trace(job, {}, sunken_machine, trace_flight).problems == problems);
  job.solver.max_time = 0.1;
  const Table early = read_trace(job, {}, sunken_machine);
  CHECK(early.status == Status::never_lifted);
  CHECK(early.problems == "the arm's tip reaches 0.66 m below the ground");
  CHECK(read_trace(accurate()).problems == "");
}

TEST_CASE("A projectile that the trough would have to hold lifts off at the start") {
  Job job = laboratory();
  job.scene.start_angle = 0.8;
  const Table table = read_trace(job, {}, {0.5, 0.3, 1.55});
  CHECK(comment(table, "lift-off-time") == 0);
  for (const auto& row : table.rows) CHECK(row.at("normal") == 0);
}

TEST_CASE("A projectile that never lifts off is traced in the trough to the end") {
  Job job = laboratory();
  job.solver.release = Release::crossing;
  job.solver.max_time = 0.2;
  const Table table = read_trace(job, {}, laboratory_machine);
  CHECK(table.status == Status::never_lifted);
  CHECK(std::isnan(comment(table, "lift-off-time")));
  CHECK(std::isnan(comment(table, "release-time")));
  CHECK(table.rows.back().at("t") == 0.2);
  CHECK(table.rows.back().at("normal") > 0);
}

TEST_CASE("A swing that ends after its lift-off without a release is traced as free") {
  Job job = laboratory();
  job.solver.release = Release::crossing;
  job.solver.max_time = 0.4;
  const Table table = read_trace(job, {}, laboratory_machine);
  CHECK(table.status == Status::not_released);
  CHECK(comment(table, "lift-off-time") == Approx(0.2532914651).margin(1e-9));
  CHECK(table.rows.back().at("normal") == 0);
}

TEST_CASE("A flight begins with the release and ends with the impact, at the published range") {
  const Table swing = laboratory_trace(), flight = read_flight(laboratory());
  CHECK(flight.header == "t x3 y3 vx vy speed");
  CHECK(flight.comments == swing.comments);
  for (const std::string name : {"t", "x3", "y3", "speed"})
    CHECK(flight.rows.front().at(name) == Approx(swing.rows.back().at(name)).margin(1e-9));
  CHECK(flight.rows.back().at("x3") == Approx(42.834641).margin(1e-5));
  CHECK(flight.rows.back().at("y3") == Approx(-0.831).margin(1e-9));
  CHECK(flight.rows.size() == 278);  // every 0.01 s, and the impact after 2.767 s
}

TEST_CASE("A flight without drag is a parabola") {
  const Table table = read_flight(laboratory(), 0.2);
  const auto& start = table.rows.front();
  for (const auto& row : table.rows) {
    const double t = row.at("t") - start.at("t");
    CHECK(row.at("x3") == Approx(start.at("x3") + t * start.at("vx")).margin(1e-8));
    CHECK(row.at("y3") ==
          Approx(start.at("y3") + t * start.at("vy") - 9.81 / 2 * t * t).margin(1e-8));
    CHECK(row.at("vy") == Approx(start.at("vy") - 9.81 * t).margin(1e-8));
  }
}

TEST_CASE("A flight through air follows the law of drag and ends as that of a sweep") {
  const Job job = laboratory_with_drag();
  constexpr double interval = 1e-3;
  const Table table = read_flight(job, interval);
  for (std::size_t i = 1; i + 2 < table.rows.size(); ++i) {
    const auto& row = table.rows[i];
    const double k = drag_constant(job.scene), ux = row.at("vx") - job.scene.wind;
    const double air_speed = std::hypot(ux, row.at("vy"));
    const auto rate = [&](const std::string& name) {
      return (table.rows[i + 1].at(name) - table.rows[i - 1].at(name)) / (2 * interval);
    };
    CHECK(rate("vx") == Approx(-k * air_speed * ux).margin(1e-6));
    CHECK(rate("vy") == Approx(-k * air_speed * row.at("vy") - 9.81).margin(1e-6));
    CHECK(rate("x3") == Approx(row.at("vx")).margin(1e-6));
    CHECK(rate("y3") == Approx(row.at("vy")).margin(1e-6));
  }
  const auto& start = table.rows.front();
  const auto whole = flight(job.scene, Vector<double>{start.at("x3"), start.at("y3")},
                            Vector<double>{start.at("vx"), start.at("vy")});
  CHECK(table.rows.back().at("x3") == Approx(whole.range).margin(1e-8));
  CHECK(table.rows.back().at("t") == Approx(start.at("t") + whole.time).margin(1e-8));
  CHECK(table.rows.back().at("speed") == Approx(whole.impact_speed).margin(1e-8));
}

TEST_CASE("The rows of a flight do not depend on the interval between them") {
  Job job = laboratory_with_drag();
  job.scene.projectile_diameter = 0.3;
  const Table coarse = read_flight(job, 1.0), fine = read_flight(job, 0.01);
  REQUIRE(coarse.rows.size() == 4);
  for (std::size_t i = 0; i < 3; ++i)
    for (const auto& [name, value] : fine.rows.at(100 * i))
      CHECK(coarse.rows[i].at(name) == Approx(value).margin(1e-9));
  CHECK(coarse.rows.back() == fine.rows.back());
}

TEST_CASE("Without a release above the ground, the table of the flight is empty") {
  Job job = laboratory();
  job.solver.release = Release::crossing;
  job.solver.max_time = 0.2;
  CHECK(read_flight(job).rows.empty());
  CHECK(read_flight(job).status == Status::never_lifted);

  job = accurate();
  job.solver.release_angle = 0.5;
  job.scene.fulcrum_height = 1.2;
  job.scene.release_height = 1.7;
  const Table buried = read_trace(job, {}, paper_optimum, trace_flight);
  CHECK(buried.status == Status::released_below_ground);
  CHECK(buried.header == "t x3 y3 vx vy speed");
  CHECK(buried.rows.empty());
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
  const auto check = [](Job job, const Design<double>& design) {
    job.solver.tolerance = 1e-9;
    const Table rows = read_trace(job, 0.003, design);
    job.solver.tolerance = 1e-13;
    const Table truth = read_trace(job, 0.003, design);
    REQUIRE(rows.rows.size() == truth.rows.size());
    for (std::size_t i = 0; i < rows.rows.size(); ++i)
      for (const auto& [name, value] : truth.rows[i]) {
        INFO(name << " at t = " << truth.rows[i].at("t"));
        CHECK(rows.rows[i].at(name) == Approx(value).epsilon(2e-8).margin(2e-8));
      }
  };
  check(accurate(), paper_optimum);
  Job job = laboratory();
  job.solver.release = Release::crossing;
  check(job, laboratory_machine);
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
                    contains("r1 = 0.4: must be at least |h - h0| = 0.5 m"));
  Job job = paper();
  job.scene.counterweight_hanger = 0.3;
  CHECK_THROWS_WITH(trace_flight(job, {0.51, 1, 1}, {}, stderr),
                    contains("r1 = 0.51: must be at least |h - h0 + r4| = 0.8 m"));
  job = laboratory();
  job.scene.start_angle = 1.2;
  CHECK_THROWS_WITH(trace(job, {0.25, 0.4, 0.975}, {}, stderr),
                    contains("r3 = 0.4: must be at least 0.477701 m, to reach the trough"));
}

TEST_CASE("An interval that would print millions of rows is an error") {
  CHECK_THROWS_WITH(trace(accurate(), paper_optimum, 1e-300, stderr),
                    contains("interval = 1e-300"));
  CHECK_THROWS_WITH(read_flight(laboratory(), 1e-7),
                    contains("interval = 1e-07: must be at least 2.76742e-07 s"));
}
