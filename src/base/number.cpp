#include "trebsweep/base/number.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

namespace trebsweep {

bool Range::contains(double x) const {
  if (zero_allowed && x == 0) return true;
  return std::isfinite(x) && (ends_allowed ? low <= x && x <= high : low < x && x < high);
}

std::string Range::text() const {
  const std::string zero = zero_allowed ? "0, or " : "";
  const std::string sign = low > 0 && !zero_allowed ? " above 0," : "";
  if (!std::isfinite(high))
    return fmt::format("{}a finite number {} {:.9g}", zero, ends_allowed ? "of at least" : "above",
                       low);
  if (ends_allowed) return fmt::format("{}a number{} from {:.9g} to {:.9g}", zero, sign, low, high);
  return fmt::format("{}a number above {:.9g} and below {:.9g}", zero, low, high);
}

std::string size_text(std::uintmax_t bytes) {
  const auto size = static_cast<double>(bytes);
  if (size >= 1e9) return fmt::format("{:.4g} GB", size / 1e9);
  return bytes >= 1'000'000 ? fmt::format("{:.4g} MB", size / 1e6) : fmt::format("{} bytes", bytes);
}

double rounded_sum(double first, std::size_t n, double step) {
  if (n == 0) return first;
  std::array<char, 32> text;
  const auto end = std::to_chars(text.begin(), text.end(), first + static_cast<double>(n) * step,
                                 std::chars_format::general, 15)
                       .ptr;
  double sum = 0;
  std::from_chars(text.begin(), end, sum);
  return sum;
}

double to_seconds(const std::string& key, const std::string& value) {
  const auto refuse_time = [&] {
    refuse(key, value,
           "a time above 0, in seconds or as [[days-]hours:]minutes:seconds, with seconds and "
           "minutes below 60 and hours below 24 after a larger unit");
  };
  constexpr std::array units{1.0, 60.0, 3600.0, 86400.0};
  double seconds = 0;
  std::string_view rest = value;
  for (std::size_t unit = 0;; ++unit) {
    // A dash separates days from hours, and nothing else.
    const auto cut = rest.find_last_of(unit == 2 ? ":-" : ":");
    const std::string_view part = cut == rest.npos ? rest : rest.substr(cut + 1);
    double number = 0;
    if (!parse_number(part, number) || !not_negative.contains(number)) refuse_time();
    seconds += number * units[unit];
    if (cut == rest.npos) break;
    if (unit + 1 == units.size() || (unit == 2) != (rest[cut] == '-')) refuse_time();
    if (number * units[unit] >= units[unit + 1]) refuse_time();
    rest = rest.substr(0, cut);
  }
  if (!positive.contains(seconds)) refuse_time();
  return seconds;
}

std::string unit_text(std::string_view units) {
  if (units == "1") return "";
  const std::string per_second = " s-1";
  if (!units.ends_with(per_second)) return std::string(units);
  return std::string(units.substr(0, units.size() - per_second.size())) + "/s";
}

}  // namespace trebsweep
