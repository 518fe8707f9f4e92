#include "trebsweep/model/jacobian.hpp"

#include <unsupported/Eigen/AutoDiff>

namespace trebsweep {

template <Effects E>
Jacobian<E> jacobian(const Motion<double, E>& motion, const State<double, E>& x) {
  constexpr auto n = static_cast<int>(coordinates<E>);
  using Dual = Eigen::AutoDiffScalar<Eigen::Matrix<double, n, 1>>;
  std::array<Dual, coordinates<E>> dual, rates;
  for (int i = 0; i < n; ++i)
    dual[static_cast<std::size_t>(i)] = Dual(x[static_cast<std::size_t>(i)], n, i);
  motion.template rates<Dual>(dual, directions<E>(dual), rates);
  Jacobian<E> derivatives;
  for (int i = 0; i < n; ++i)
    derivatives.row(i) = rates[static_cast<std::size_t>(i)].derivatives().transpose();
  return derivatives;
}

static_assert(all_effects.size() == 10);
template Jacobian<all_effects[0]> jacobian(const Motion<double, all_effects[0]>&,
                                           const State<double, all_effects[0]>&);
template Jacobian<all_effects[1]> jacobian(const Motion<double, all_effects[1]>&,
                                           const State<double, all_effects[1]>&);
template Jacobian<all_effects[2]> jacobian(const Motion<double, all_effects[2]>&,
                                           const State<double, all_effects[2]>&);
template Jacobian<all_effects[3]> jacobian(const Motion<double, all_effects[3]>&,
                                           const State<double, all_effects[3]>&);
template Jacobian<all_effects[4]> jacobian(const Motion<double, all_effects[4]>&,
                                           const State<double, all_effects[4]>&);
template Jacobian<all_effects[5]> jacobian(const Motion<double, all_effects[5]>&,
                                           const State<double, all_effects[5]>&);
template Jacobian<all_effects[6]> jacobian(const Motion<double, all_effects[6]>&,
                                           const State<double, all_effects[6]>&);
template Jacobian<all_effects[7]> jacobian(const Motion<double, all_effects[7]>&,
                                           const State<double, all_effects[7]>&);
template Jacobian<all_effects[8]> jacobian(const Motion<double, all_effects[8]>&,
                                           const State<double, all_effects[8]>&);
template Jacobian<all_effects[9]> jacobian(const Motion<double, all_effects[9]>&,
                                           const State<double, all_effects[9]>&);

}  // namespace trebsweep
