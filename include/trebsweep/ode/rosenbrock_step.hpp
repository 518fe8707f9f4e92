#pragma once

#include <functional>
#include <memory>

namespace trebsweep {

/// A step of Odeint's rosenbrock4, with plain arrays of n numbers in its interface. Odeint uses
/// uBLAS, which Boost 1.74 does not support in C++20, so that the source is compiled as C++17.
class RosenbrockStep {
 public:
  using Rates = std::function<void(const double* x, double* dxdt)>;
  using Derivatives =
      std::function<void(const double* x, double* rows)>;  ///< the Jacobian, n x n, row by row

  explicit RosenbrockStep(std::size_t n);
  ~RosenbrockStep();

  static int order();
  static int error_order();

  /// Takes a step of length h from x for an autonomous system: sets the state at its end and the
  /// estimate of the local error.
  void step(const Rates& rates, const Derivatives& derivatives, const double* x, double h,
            double* end, double* error);

 private:
  struct Storage;
  std::unique_ptr<Storage> storage_;
};

}  // namespace trebsweep
