#pragma once

#include <vector>

namespace trebsweep {

/// Median, 95th percentile and maximum of a sample of n numbers. Quantile p is the element with
/// index round(p (n - 1)) in ascending order; no interpolation. NaN for an empty sample.
struct ErrorQuantiles {
  double median;
  double p95;  ///< about 95 % of the errors are not larger
  double largest;
};

ErrorQuantiles error_quantiles(std::vector<double> errors);

}  // namespace trebsweep
