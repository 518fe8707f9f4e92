#pragma once

#include <complex>
#include <span>
#include <string>
#include <vector>

#include "trebsweep/swing/reference.hpp"
#include "trebsweep/swing/spectrum.hpp"

namespace trebsweep {

/// By how much a step of the stepper multiplies a solution of y' = y z, over a time of one: its
/// stability function. The stepper itself is run. Not of bulirsch_stoer and
/// adams_bashforth_moulton, whose steps are not of one kind.
bool has_stability_function(const std::string& stepper);
std::complex<double> stability_function(const std::string& stepper, const std::complex<double>& z);

/// The factor, beyond that of the exact solution, by which steps of length h multiply the swing's
/// oscillating and decaying modes, as far as they grow: along the swing, of the fastest at each
/// moment.
double amplification(const std::string& stepper, const std::vector<Spectrum>& spectra, double h);

/// The largest step (s) whose amplification is below 2, that of shorter ones too.
double largest_stable_step(const std::string& stepper, const std::vector<Spectrum>& spectra);

/// The state after `steps` steps of one length to the reference's release: its largest error, of a
/// coordinate, over one and that coordinate; infinite where it is not finite. In long double, where
/// the stepper can. Not of
/// bulirsch_stoer.
double error_of_steps(const std::string& stepper, const Scene& scene, const Design<double>& design,
                      const Reference& reference, std::uint64_t steps);

/// The largest step (s) seen to be of use: with an error_of_steps() below 10 %, like that of
/// shorter steps down to a quarter of `guess`.
double largest_usable_step(const std::string& stepper, const Scene& scene,
                           const Design<double>& design, const Reference& reference, double guess);

/// The order of convergence seen with steps of one length, as the median over designs with a shot:
/// from the finest two steps, one half of the other, whose errors are above rounding. NaN where
/// there are none.
double observed_order(const std::string& stepper, const Scene& scene,
                      std::span<const Design<double>> designs,
                      std::span<const Reference> references);

/// What becomes of a small oscillation about the hanging equilibrium, which the equations keep as
/// it is, in steps of one length.
struct Growth {
  double rate;       ///< rad/s: of the fastest mode, which oscillates
  double predicted;  ///< factor of its amplitude by the stability function
  double seen;       ///< factor of its amplitude, from the energy
};

/// Of a rigid sling without friction; over `time` (s), in steps of length h (s).
Growth growth(const std::string& stepper, const Scene& scene, const Design<double>& design,
              double h, double time);

}  // namespace trebsweep
