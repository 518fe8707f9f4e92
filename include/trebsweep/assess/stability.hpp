#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "trebsweep/swing/reference.hpp"
#include "trebsweep/swing/spectrum.hpp"

namespace trebsweep {

/// Whether every step of the stepper applies the same function of h z to y' = z y. False for
/// bulirsch_stoer, whose order varies, and adams_bashforth_moulton, whose steps use earlier ones.
bool has_stability_function(const std::string& stepper);

/// The stability function R(z) of a stepper, evaluated by running it: a step of length 1 from
/// y = 1 of y' = z y. Throws std::logic_error if the stepper has none.
std::complex<double> stability_function(const std::string& stepper, const std::complex<double>& z);

/// The factor by which steps of length h (s) amplify an error along the swing, relative to the
/// exact solution: the product over the swing of |R(h lambda)| / max(1, |exp(h lambda)|) of the
/// most amplified eigenvalue lambda at each time. Only oscillating and decaying modes count; the
/// factor is at least 1.
double amplification(const std::string& stepper, const std::vector<Spectrum>& spectra, double h);

/// The largest step (s) such that it and all shorter steps have an amplification() below 2;
/// infinite if there is no limit, as for an A-stable stepper.
double largest_stable_step(const std::string& stepper, const std::vector<Spectrum>& spectra);

/// Integrates to the reference's release with `steps` equal steps, in long double if the stepper
/// supports it. Returns the largest |x - truth| / (1 + |truth|) over the components of the final
/// state; infinite if it is not finite. Not for bulirsch_stoer.
double error_of_steps(const std::string& stepper, const Scene& scene, const Design<double>& design,
                      const Reference& reference, std::uint64_t steps);

/// The largest step (s) such that it and the shorter steps tried, down to a quarter of `guess` (s),
/// have an error_of_steps() of at most 10 %; NaN if the first one tried exceeds that.
double largest_usable_step(const std::string& stepper, const Scene& scene,
                           const Design<double>& design, const Reference& reference, double guess);

/// Observed order of convergence with equal steps: the median over the designs with a release. For
/// each design it is log2 of the ratio of the errors of the two finest steps, one half of the
/// other, whose errors are above rounding. NaN if no design has such steps.
double observed_order(const std::string& stepper, const Scene& scene,
                      std::span<const Design<double>> designs,
                      std::span<const Reference> references);

/// Amplification of a small oscillation about the hanging equilibrium. Its exact amplitude is
/// constant.
struct Growth {
  double rate;       ///< angular frequency of the fastest mode, which oscillates; rad/s
  double predicted;  ///< growth factor of its amplitude according to the stability function
  double observed;   ///< growth factor of its amplitude, computed from the energy
};

/// Integrates over `time` (s) in steps of length h (s). For a rigid sling without friction.
Growth growth(const std::string& stepper, const Scene& scene, const Design<double>& design,
              double h, double time);

}  // namespace trebsweep
