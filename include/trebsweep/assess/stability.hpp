#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "trebsweep/swing/reference.hpp"
#include "trebsweep/swing/spectrum.hpp"

namespace trebsweep {

/// Whether every step of the stepper multiplies the solution of y' = z y by the same function of
/// h z. False for bulirsch_stoer, whose order varies, and for adams_bashforth_moulton, a multistep
/// method.
bool has_stability_function(const std::string& stepper);

/// The stability function R(z) of a stepper, evaluated by taking a step: the result for y' = z y
/// after a step of length 1 from y = 1. Throws std::logic_error if the stepper has none.
std::complex<double> stability_function(const std::string& stepper, const std::complex<double>& z);

/// The factor by which steps of length h (s) amplify an error along the swing, relative to the
/// exact solution: the product of |R(h lambda)| / max(1, |exp(h lambda)|) over the steps, where
/// lambda is the eigenvalue for which the quotient is largest. Includes only oscillating and
/// decaying modes, and only quotients above 1.
double amplification(const std::string& stepper, const std::vector<Spectrum>& spectra, double h);

/// The largest step (s) such that it and all shorter steps have an amplification() below 2;
/// infinite if there is no limit, as for an A-stable stepper.
double largest_stable_step(const std::string& stepper, const std::vector<Spectrum>& spectra);

/// The numbers of equal steps in the phases of a swing: in the trough, if there is one, and free.
struct StepCounts {
  std::uint64_t sliding, free;
};

/// Integrates to the reference's release with equal steps in each phase, in long double if the
/// stepper supports it. Lift-off is not located, but takes place at its true time: the error is
/// that of the steps alone. Returns the largest |x - truth| / (1 + |truth|) over the components of
/// the final state; infinite if it is not finite. Not for bulirsch_stoer.
double error_of_steps(const std::string& stepper, const Scene& scene, const Design<double>& design,
                      const Reference& reference, const StepCounts& steps);

/// The largest step (s) tried such that it and all shorter ones tried have an error_of_steps() of
/// at most 10 %. The first is a quarter of `guess` (s), or an eighth of the swing if that is
/// shorter. NaN if the first fails, or needs more than 1e7 steps.
double largest_usable_step(const std::string& stepper, const Scene& scene,
                           const Design<double>& design, const Reference& reference, double guess);

/// Observed order of convergence with equal steps: the median over the designs with a release. The
/// order of a design is log2 of the ratio of the errors of two steps, one twice as long as the
/// other: the shortest two whose errors exceed rounding. With a trough, half of the steps are
/// before lift-off. NaN if no design has such steps.
double observed_order(const std::string& stepper, const Scene& scene,
                      std::span<const Design<double>> designs,
                      std::span<const Reference> references);

/// Growth of a small oscillation about the hanging equilibrium, whose exact amplitude is constant.
struct Growth {
  double rate;       ///< angular frequency of the fastest mode, which oscillates; rad/s
  double predicted;  ///< growth factor of its amplitude according to the stability function
  double observed;   ///< growth factor of its amplitude, computed from the energy
};

/// The growth over `time` (s) with steps of length h (s), without contact with a trough. For a
/// rigid sling without friction.
Growth growth(const std::string& stepper, const Scene& scene, const Design<double>& design,
              double h, double time);

}  // namespace trebsweep
