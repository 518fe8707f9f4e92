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
  motion.template rates<Dual>(dual, directions(dual), rates);
  Jacobian<E> derivatives;
  for (int i = 0; i < n; ++i)
    derivatives.row(i) = rates[static_cast<std::size_t>(i)].derivatives().transpose();
  return derivatives;
}

template Jacobian<Effects{false, false}> jacobian(const Motion<double, Effects{false, false}>&,
                                                  const State<double, Effects{false, false}>&);
template Jacobian<Effects{false, true}> jacobian(const Motion<double, Effects{false, true}>&,
                                                 const State<double, Effects{false, true}>&);
template Jacobian<Effects{true, false}> jacobian(const Motion<double, Effects{true, false}>&,
                                                 const State<double, Effects{true, false}>&);
template Jacobian<Effects{true, true}> jacobian(const Motion<double, Effects{true, true}>&,
                                                const State<double, Effects{true, true}>&);

}  // namespace trebsweep
