#include "trebsweep/job/outer_axis.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <boost/algorithm/string.hpp>
#include <cmath>

#include "trebsweep/base/error.hpp"
#include "trebsweep/job/key_kinds.hpp"
#include "trebsweep/job/unit.hpp"

namespace trebsweep {
namespace {

constexpr double max_values = 1e6;

/// Throws InputError if two neighbours among ascending values are equal.
void require_distinct(const std::string& key, const std::string& text,
                      const std::vector<double>& values) {
  if (const auto twice = std::ranges::adjacent_find(values); twice != values.end())
    refuse(key, text, fmt::format("numbers that differ; {} is repeated", *twice));
}

/// The values of a range with a text.
std::vector<double> range_values(const std::string& key, const std::string& text,
                                 const AxisRange& range) {
  const auto [first, last, step] = range;
  const double steps = std::round((last - first) / step);
  if (steps + 1 > max_values)
    refuse(key, text, fmt::format("a range of at most {:.0f} values", max_values));
  std::vector<double> values;
  for (std::size_t i = 0; i <= static_cast<std::size_t>(steps); ++i)
    values.push_back(rounded_sum(first, i, step));
  require_distinct(key, text, values);  // a step may be lost in the rounding
  return values;
}

/// The values of a list, in ascending order.
std::vector<double> list_values(const std::string& key, const std::string& text,
                                const std::function<double(const std::string&)>& parse) {
  std::vector<std::string> parts;
  boost::split(parts, text, boost::is_any_of(","));
  check_units_agree(key, text, parts);
  std::vector<double> values;
  for (const std::string& part : parts) {
    const std::string number = boost::trim_copy(part);
    if (number.empty()) refuse(key, text, "numbers separated by commas, or first:last:step");
    values.push_back(parse(number));
  }
  std::ranges::sort(values);
  require_distinct(key, text, values);
  return values;
}

}  // namespace

bool has_several_values(const std::string& text) {
  return text.find_first_of(",:") != std::string::npos;
}

OuterAxis to_outer_axis(const std::string& key, const std::string& text, const std::string& unit,
                        const std::function<double(const std::string&)>& parse) {
  if (text.find(':') == std::string::npos) {
    const auto values = list_values(key, text, parse);
    return {key, values, fmt::format("{}", fmt::join(values, ", "))};
  }
  const AxisRange range = to_range(key, text, unit, parse, "numbers separated by commas");
  const bool has_units = text.find_first_not_of("0123456789+-.eE: ") != std::string::npos;
  return {key, range_values(key, text, range),
          has_units ? to_text(range) : boost::erase_all_copy(text, " ")};
}

}  // namespace trebsweep
