#include "trebsweep/optimum/coarse_grid.hpp"

#include <array>
#include <cmath>
#include <set>

#include "optimum/jobs.hpp"
#include "support/catch.hpp"
#include "trebsweep/base/error.hpp"
#include "trebsweep/model/start.hpp"
#include "trebsweep/optimum/design_problem.hpp"

using namespace trebsweep;
using Eigen::Index;

namespace {

Job variable_job() {
  return job_with({{"optimum.variables", "fulcrum-height 1.2:1.8, counterweight-mass 2000:6000"}});
}

}  // namespace

TEST_CASE("A grid of a Sobol sequence spreads over variables and lengths, within their limits") {
  const Job job = variable_job();
  const Grid grid = sobol_grid(job, 100'000);
  CHECK(grid.parameters.rows() == 5);
  CHECK(grid.parameters.cols() > 80'000);
  CHECK(grid.parameters.cols() <= 100'000);
  const DesignSpace space = design_space(job);
  std::set<double> heights;
  double largest_excess = -1;
  for (const auto& parameters : grid.parameters.colwise()) {
    const Job at = with_variables(job, parameters.tail(2));
    heights.insert(at.scene.fulcrum_height);
    for (const SpaceLimit& limit : space.limits)
      largest_excess = std::max(largest_excess, limit.excess(at.scene, to_design(parameters)));
  }
  CHECK(largest_excess < 0);
  CHECK(std::ssize(heights) == Approx(100).margin(1));  // 100000^(2/5) scenes
  const auto& all = grid.parameters;
  CHECK((all.rowwise().minCoeff() - space.lower).minCoeff() >= 0);
  CHECK((space.upper - all.rowwise().maxCoeff()).minCoeff() >= 0);
  CHECK(all.row(4).mean() == Approx(4000).epsilon(0.01));
  // The lengths of each scene are others.
  CHECK((all.col(0) - all.col(all.cols() / 2)).head(3).norm() > 0);
}

TEST_CASE("A grid of a Sobol sequence keeps fixed lengths, and says that there are no designs") {
  Job job = variable_job();
  job.lattice.r3 = AxisRange{0.5, 0.5, 1};
  const Grid grid = sobol_grid(job, 1'000);
  CHECK((grid.parameters.row(1).array() == 0.5).all());
  job.lattice.r3 = AxisRange{2, 2, 1};  // longer than any h0
  CHECK_THROWS_AS(sobol_grid(job, 1'000), NoOptimum);
}

TEST_CASE("Designs are found where few values of a variable allow any") {
  // r2 + r3 <= h0, for which h0 has to be in the highest 2.5 % of its range.
  const Job job = job_from(
      "[lattice]\nr3 = 1.195\nr1 = 0.3\n"
      "[optimum]\nvariables = fulcrum-height 1:1.2\n");
  const Grid grid = sobol_grid(job, 500);
  CHECK(grid.parameters.cols() > 0);
}

TEST_CASE("Designs of a grid satisfy what their start shows, if any do") {
  Job job = job_from(
      "[scene]\ntrough = yes\nstart-angle = 0.5\n"
      "[optimum]\nvariables = start-angle 0.3:1.2\nsubject-to = r1 + r2 <= 1.2, speed >= 1\n");
  const auto fractions = [](const Job& searched) {
    const Grid grid = sobol_grid(searched, 5'000);
    std::array<double, 3> parts{};
    for (const auto& parameters : grid.parameters.colwise()) {
      const Scene scene = with_variables(searched, parameters.tail(1)).scene;
      const Design<double> d = to_design(parameters);
      parts[0] += d.r1 + d.r2 <= 1.2;
      parts[1] += d.r2 * std::cos(*scene.start_angle) <= scene.fulcrum_height;
      parts[2] += sling_reaches_trough(scene, d);
    }
    for (double& part : parts) part /= static_cast<double>(grid.parameters.cols());
    return parts;
  };
  CHECK(fractions(searched_job(job)) == std::array{1.0, 1.0, 1.0});
  job.optimum.constraints.front().limit = 0.001;  // excludes all designs
  const auto without = fractions(searched_job(job));
  CHECK(without[0] < 1);
  CHECK(without[2] < 1);
}

TEST_CASE("Arms that start with their tips on the ground are in the grid of a machine to build") {
  const Job job =
      job_from("[scene]\nstart-tip-height = 0\n[optimum]\nvariables = fulcrum-height 1.2:1.8\n");
  const Grid grid = sobol_grid(searched_job(job), 5'000);
  CHECK(grid.parameters.cols() > 4'000);
}

TEST_CASE("Maxima of a grid without a lattice have no better one within a spacing") {
  const Job job = variable_job();
  const Grid grid = sobol_grid(job, 10'000);
  std::vector<Merit> merit;
  for (const auto& x : grid.parameters.colwise())
    merit.push_back({std::sin(9 * x(0)) * std::cos(7 * x(2)) - std::pow(x(3) - 1.4, 2), 0});
  const auto maxima = local_maxima(grid, merit);
  REQUIRE(maxima.size() > 2);
  CHECK(merit[maxima.front()].objective ==
        std::ranges::max(merit, {}, &Merit::objective).objective);
  const auto place = [&](std::size_t m) {
    return grid.parameters.col(static_cast<Index>(m)).cwiseQuotient(grid.spacing).eval();
  };
  for (std::size_t i = 1; i < maxima.size(); ++i) {
    CHECK(merit[maxima[i]].objective <= merit[maxima[i - 1]].objective);
    for (std::size_t j = 0; j < i; ++j)
      CHECK((place(maxima[i]) - place(maxima[j])).lpNorm<Eigen::Infinity>() >= 1);
  }
}
