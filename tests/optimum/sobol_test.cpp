#include "trebsweep/optimum/sobol.hpp"

#include "support/catch.hpp"

using namespace trebsweep;
using Eigen::MatrixXd;
using Eigen::Vector3d;

TEST_CASE("A Sobol sequence fills its box evenly, from the middle, and keeps fixed coordinates") {
  SobolSequence sequence(Vector3d{-1, 5, 0}, Vector3d{1, 5, 4});
  const MatrixXd points = sequence.next(64);
  CHECK(points.col(0) == Vector3d{0, 5, 2});
  CHECK((points.row(1).array() == 5).all());
  // Each of 4 by 4 cells has its share, give or take one.
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) {
      const auto in_cell = (points.row(0).array() >= -1 + 0.5 * i) &&
                           (points.row(0).array() < -0.5 + 0.5 * i) &&
                           (points.row(2).array() >= j) && (points.row(2).array() < j + 1);
      CHECK(std::abs(static_cast<int>(in_cell.count()) - 4) <= 1);
    }
  SobolSequence again(Vector3d{-1, 5, 0}, Vector3d{1, 5, 4});
  again.next(63);
  CHECK(again.next() == points.col(63));
}
