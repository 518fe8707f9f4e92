#pragma once

#include <complex>
#include <vector>

#include "trebsweep/model/scene.hpp"
#include "trebsweep/ode/solver.hpp"

namespace trebsweep {

/// Eigenvalues (1/s) of the equations' Jacobian at the end of a step of a swing, and that step.
struct Spectrum {
  double h;  ///< s
  std::vector<std::complex<double>> eigenvalues;
};

/// The spectra along a swing to its release or its end. Of the solver, its limits count: the swing
/// is that of rosenbrock4, whose steps no stiffness shortens.
std::vector<Spectrum> spectra(const Scene& scene, const Design<double>& design, Solver solver);

/// How stiff a swing is.
struct Stiffness {
  double modulus = 0;  ///< 1/s: the largest modulus of an eigenvalue
  double decay = 0;    ///< 1/s: the largest negative real part; 0 where nothing decays
};

Stiffness stiffness(const std::vector<Spectrum>& spectra);

}  // namespace trebsweep
