#include "trebsweep/assess/error_quantiles.hpp"

#include <cmath>

#include "support/catch.hpp"

using namespace trebsweep;

TEST_CASE("Quantiles are the median, the 95th percentile and the maximum, and NaN for no errors") {
  std::vector<double> values;
  for (int i = 100; i >= 0; --i) values.push_back(i);
  const auto [median, p95, largest] = error_quantiles(values);
  CHECK(median == 50);
  CHECK(p95 == 95);
  CHECK(largest == 100);
  CHECK(std::isnan(error_quantiles({}).median));
}
