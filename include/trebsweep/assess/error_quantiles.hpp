#pragma once

#include <vector>

namespace trebsweep {

/// Median, 95th percentile and maximum of a sample. Each is an element of the sample (nearest rank,
/// not interpolated); NaN for an empty sample.
struct ErrorQuantiles {
  double median;
  double p95;  ///< 95 % of the errors are not larger
  double largest;
};

ErrorQuantiles error_quantiles(std::vector<double> errors);

}  // namespace trebsweep
