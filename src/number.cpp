#include "trebsweep/number.hpp"

#include <fmt/format.h>

#include <cmath>

#include "trebsweep/error.hpp"

namespace trebsweep {

void refuse(const std::string& key, const std::string& value, const std::string& allowed) {
  throw InputError(fmt::format("{} = {}: must be {}", key, value, allowed));
}

bool Range::contains(double x) const {
  return std::isfinite(x) && x <= high && (low_allowed ? x >= low : x > low);
}

std::string Range::text() const {
  if (std::isfinite(high)) return fmt::format("a number from {:.15g} to {:.15g}", low, high);
  return fmt::format("a finite number {} {:.15g}", low_allowed ? "not below" : "above", low);
}

double to_number(const std::string& key, const std::string& value, const Range& range) {
  double number = 0;
  if (!parses(value, number) || !range.contains(number)) refuse(key, value, range.text());
  return number;
}

}  // namespace trebsweep
