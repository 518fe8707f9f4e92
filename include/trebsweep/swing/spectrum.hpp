#pragma once

#include <complex>
#include <span>
#include <vector>

#include "trebsweep/model/scene.hpp"
#include "trebsweep/ode/solver.hpp"

namespace trebsweep {

// Not in Eigen's matrices of variable size, whose memory code with sanitizers cannot free.

/// An eigenvalue of a matrix and its eigenvector.
struct Mode {
  std::complex<double> eigenvalue;
  std::vector<std::complex<double>> eigenvector;
};

/// Those of a square matrix, which is given column by column.
std::vector<Mode> modes(std::span<const double> matrix);

/// The eigenvalues (1/s) of the Jacobian at the end of a step of a swing, and the step length.
struct Spectrum {
  double h;  ///< s
  std::vector<std::complex<double>> eigenvalues;
};

/// The spectra along a swing, integrated by rosenbrock4, whose steps stiffness does not limit. Only
/// max_time and max_steps of `solver` are used.
std::vector<Spectrum> spectra(const Scene& scene, const Design<double>& design, Solver solver);

/// Stiffness of a swing.
struct Stiffness {
  double modulus = 0;  ///< 1/s: the largest modulus of an eigenvalue
  double decay = 0;    ///< 1/s: the largest negative real part; 0 where nothing decays
};

Stiffness stiffness(const std::vector<Spectrum>& spectra);

}  // namespace trebsweep
