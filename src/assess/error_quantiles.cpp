#include "trebsweep/assess/error_quantiles.hpp"

#include <algorithm>
#include <limits>

namespace trebsweep {

ErrorQuantiles error_quantiles(std::vector<double> errors) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  if (errors.empty()) return {nan, nan, nan};
  std::sort(errors.begin(), errors.end());
  const auto quantile = [&](double p) {
    return errors[static_cast<std::size_t>(p * static_cast<double>(errors.size() - 1) + 0.5)];
  };
  return {quantile(0.5), quantile(0.95), errors.back()};
}

}  // namespace trebsweep
