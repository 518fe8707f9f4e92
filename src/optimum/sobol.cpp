#include "trebsweep/optimum/sobol.hpp"

#include <boost/random/uniform_real_distribution.hpp>

namespace trebsweep {

SobolSequence::SobolSequence(const Eigen::VectorXd& lower, const Eigen::VectorXd& upper)
    : lower_(lower), upper_(upper) {
  for (Eigen::Index d = 0; d < lower.size(); ++d)
    if (lower(d) < upper(d)) free_.push_back(d);
  if (!free_.empty()) sequence_.emplace(free_.size());
}

Eigen::VectorXd SobolSequence::next() {
  Eigen::VectorXd point = lower_;
  for (const Eigen::Index d : free_)
    point(d) = boost::random::uniform_real_distribution(lower_(d), upper_(d))(*sequence_);
  return point;
}

Eigen::MatrixXd SobolSequence::next(Eigen::Index count) {
  Eigen::MatrixXd points(lower_.size(), count);
  for (auto point : points.colwise()) point = next();
  return points;
}

}  // namespace trebsweep
