#include "trebsweep/optimum/coarse_grid.hpp"

#include "optimum/jobs.hpp"
#include "support/catch.hpp"
#include "trebsweep/base/error.hpp"

using namespace trebsweep;
using Eigen::Index;
using Eigen::MatrixXd;

namespace {

Job variable_job() {
  return job_with({{"optimum.variables", "fulcrum-height 1.2:1.8, counterweight-mass 2000:6000"}});
}

LatticeSpec with_increment(double increment) {
  LatticeSpec spec;
  spec.increment = increment;
  return spec;
}

}  // namespace

TEST_CASE("Scenes are spread over the box of the variables, as many as the lengths leave") {
  const Job job = variable_job();
  const MatrixXd scenes = coarse_scenes(job, 100'000);
  REQUIRE(scenes.rows() == 2);
  CHECK(scenes.cols() == 100);  // of five parameters, two are variables: 100000^(2/5)
  const auto masses = scenes.row(1), heights = scenes.row(0);
  CHECK(heights.minCoeff() >= 1.2);
  CHECK(heights.maxCoeff() <= 1.8);
  CHECK(heights.mean() == Approx(1.5).epsilon(0.01));
  CHECK(masses.mean() == Approx(4000).epsilon(0.01));
  CHECK(coarse_scenes(Job{}, 100'000).cols() == 1);
}

TEST_CASE("A grid has the lattice of each scene, without scenes that have no design") {
  const Job job = variable_job();
  MatrixXd scenes(2, 3);
  scenes << 1.2, 1.8, 1.01, 3000, 4000, 5000;
  const LatticeSpec spec = with_increment(0.2);
  const Grid grid = grid_of(job, spec, scenes.leftCols(2));
  Index column = 0;
  for (const Index scene : {0, 1}) {
    Scene at = job.scene;
    at.fulcrum_height = scenes(0, scene);
    for (std::uint64_t n = Lattice(at, spec).designs(); n > 0; --n, ++column)
      CHECK(grid.parameters.col(column).tail(2) == scenes.col(scene));
  }
  CHECK(grid.parameters.cols() == column);
  scenes(0, 2) = 0.9;  // below half of the release height: r1 > h - h0 > h0
  CHECK(grid_of(job, spec, scenes).lattices.size() == 2);
  CHECK_THROWS_AS(grid_of(job, spec, scenes.rightCols(1)), InputError);
}

TEST_CASE("Maxima of several scenes have no better one within a spacing") {
  const Job job = variable_job();
  const Grid grid = grid_of(job, with_increment(0.1), coarse_scenes(job, 10'000));
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
