#pragma once

#include <functional>
#include <memory>

namespace trebsweep {

/// A step of Odeint's rosenbrock4 behind plain arrays, of n numbers each: Odeint keeps them in
/// uBLAS, which is no C++20 in Boost 1.74, so that its file is compiled as C++17.
class RosenbrockStep {
 public:
  using Rates = std::function<void(const double* x, double* dxdt)>;
  using Derivatives = std::function<void(const double* x, double* rows)>;  ///< n x n

  explicit RosenbrockStep(std::size_t n);
  ~RosenbrockStep();

  static int order();
  static int error_order();

  /// A step of length h from x, for equations without time: its end, and an estimate of its error.
  void step(const Rates& rates, const Derivatives& derivatives, const double* x, double h,
            double* end, double* error);

 private:
  struct Storage;
  std::unique_ptr<Storage> storage_;
};

}  // namespace trebsweep
