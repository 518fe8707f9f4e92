#pragma once

#include <Eigen/Core>
#include <boost/random/sobol.hpp>
#include <optional>
#include <vector>

namespace trebsweep {

/// The points of a Sobol sequence in a box, the middle first. Coordinates in which the box has no
/// width do not use a dimension of the sequence.
class SobolSequence {
 public:
  SobolSequence(const Eigen::VectorXd& lower, const Eigen::VectorXd& upper);

  Eigen::VectorXd next();

  /// The next points, a column each.
  Eigen::MatrixXd next(Eigen::Index count);

 private:
  Eigen::VectorXd lower_, upper_;
  std::vector<Eigen::Index> free_;
  std::optional<boost::random::sobol> sequence_;
};

}  // namespace trebsweep
