#include "trebsweep/swing/spectrum.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "trebsweep/model/jacobian.hpp"
#include "trebsweep/swing/swing.hpp"

namespace trebsweep {
namespace {

// Matrices of any size: fixed sizes would give the same numbers and take long to compile.
using EigenSolver = Eigen::EigenSolver<Eigen::MatrixXd>;

std::vector<std::complex<double>> eigenvalues(const Eigen::MatrixXd& matrix) {
  const EigenSolver solver(matrix, false);
  return {solver.eigenvalues().begin(), solver.eigenvalues().end()};
}

}  // namespace

std::vector<Mode> modes(std::span<const double> matrix) {
  const auto n = static_cast<Eigen::Index>(std::lround(std::sqrt(matrix.size())));
  const EigenSolver solver(Eigen::Map<const Eigen::MatrixXd>(matrix.data(), n, n));
  const Eigen::MatrixXcd vectors = solver.eigenvectors();
  std::vector<Mode> modes;
  for (Eigen::Index i = 0; i < vectors.cols(); ++i)
    modes.push_back({solver.eigenvalues()(i), {vectors.col(i).begin(), vectors.col(i).end()}});
  return modes;
}

std::vector<Spectrum> spectra(const Scene& scene, const Design<double>& design, Solver solver) {
  solver.stepper = "rosenbrock4";
  solver.release = located(solver.release);
  solver.tolerance = 1e-5;
  return with_general_effects(scene, [&]<Effects E>() {
    Motion<double, E> motion(scene, design);
    // The step in the trough that ends at the lift-off has no normal force at its end.
    const double small_force = 1e-6 * scene.projectile_mass * scene.gravity;
    std::vector<Spectrum> spectra;
    const auto add = [&](double h, const State<double, E>& x) {
      const Jacobian<E> j = jacobian(motion, x);
      if (!j.allFinite()) return;
      spectra.push_back({h, eigenvalues(j)});
    };
    const auto observe = [&](const Instant<double, E>& from, const Instant<double, E>& to) {
      if (spectra.empty()) {
        if (motion.normal_force(from.x, from.directions) <= 0) motion.set_sliding(0);
        add(0, from.x);
      }
      add(to.t - from.t, to.x);
      if (motion.sliding() > 0 && motion.normal_force(to.x, to.directions) < small_force)
        motion.set_sliding(0);
    };
    swing<E>(scene, design, solver, observe);
    return spectra;
  });
}

Stiffness stiffness(const std::vector<Spectrum>& spectra) {
  Stiffness most;
  for (const Spectrum& spectrum : spectra)
    for (const std::complex<double>& eigenvalue : spectrum.eigenvalues) {
      most.modulus = std::max(most.modulus, std::abs(eigenvalue));
      most.decay = std::max(most.decay, -eigenvalue.real());
    }
  return most;
}

}  // namespace trebsweep
