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

static_assert(general_effects.size() == 5);
template Jacobian<general_effects[0]> jacobian(const Motion<double, general_effects[0]>&,
                                               const State<double, general_effects[0]>&);
template Jacobian<general_effects[1]> jacobian(const Motion<double, general_effects[1]>&,
                                               const State<double, general_effects[1]>&);
template Jacobian<general_effects[2]> jacobian(const Motion<double, general_effects[2]>&,
                                               const State<double, general_effects[2]>&);
template Jacobian<general_effects[3]> jacobian(const Motion<double, general_effects[3]>&,
                                               const State<double, general_effects[3]>&);
template Jacobian<general_effects[4]> jacobian(const Motion<double, general_effects[4]>&,
                                               const State<double, general_effects[4]>&);

}  // namespace trebsweep
