#include "trebsweep/base/number.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include "trebsweep/base/error.hpp"

namespace trebsweep {

std::string shortened(const std::string& text) {
  constexpr std::size_t most = 200;
  return text.size() <= most ? text : text.substr(0, most) + "...";
}

std::string printable(std::string text) {
  const auto is_control = [](unsigned char c) { return std::iscntrl(c) != 0; };
  std::replace_if(text.begin(), text.end(), is_control, '?');
  return text;
}

void refuse(const std::string& key, const std::string& value, const std::string& allowed) {
  throw InputError(fmt::format("{} = {}: must be {}", key, shortened(value), allowed));
}

bool Range::contains(double x) const {
  if (zero_allowed && x == 0) return true;
  return std::isfinite(x) && (ends_allowed ? low <= x && x <= high : low < x && x < high);
}

std::string Range::text() const {
  const std::string zero = zero_allowed ? "0, or " : "";
  const std::string sign = low > 0 && !zero_allowed ? " above 0," : "";
  if (!std::isfinite(high))
    return fmt::format("{}a finite number {} {:.9g}", zero, ends_allowed ? "not below" : "above",
                       low);
  if (ends_allowed) return fmt::format("{}a number{} from {:.9g} to {:.9g}", zero, sign, low, high);
  return fmt::format("{}a number above {:.9g} and below {:.9g}", zero, low, high);
}

double to_number(const std::string& key, const std::string& value, const Range& range) {
  double number = 0;
  if (!parses(value, number) || !range.contains(number)) refuse(key, value, range.text());
  return number;
}

double to_seconds(const std::string& key, const std::string& value) {
  const auto refuse_time = [&] {
    refuse(key, value, "seconds, or [[days-]hours:]minutes:seconds, above 0");
  };
  constexpr std::array units{1.0, 60.0, 3600.0, 86400.0};
  double seconds = 0;
  std::string_view rest = value;
  for (std::size_t unit = 0;; ++unit) {
    // Days only before hours, and set off by a dash.
    const auto cut = rest.find_last_of(unit == 2 ? ":-" : ":");
    const std::string_view part = cut == rest.npos ? rest : rest.substr(cut + 1);
    double number = 0;
    if (!parses(part, number) || !not_negative.contains(number)) refuse_time();
    seconds += number * units[unit];
    if (cut == rest.npos) break;
    if (unit + 1 == units.size() || (unit == 2) != (rest[cut] == '-')) refuse_time();
    rest = rest.substr(0, cut);
  }
  if (!positive.contains(seconds)) refuse_time();
  return seconds;
}

}  // namespace trebsweep
