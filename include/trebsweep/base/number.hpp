#pragma once

#include <charconv>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

#include "trebsweep/base/error.hpp"

namespace trebsweep {

/// A range of finite numbers that a key allows.
struct Range {
  double low;
  double high = std::numeric_limits<double>::infinity();
  bool ends_allowed = true;   ///< whether `low` and a finite `high` are in the range
  bool zero_allowed = false;  ///< whether 0 is allowed in addition

  bool contains(double x) const;
  std::string text() const;  ///< for messages: "a finite number above 0"
};

inline constexpr Range positive{0, std::numeric_limits<double>::infinity(), false};
inline constexpr Range not_negative{0};

/// Physical quantities in SI units. Far beyond these magnitudes intermediate results overflow or
/// underflow.
inline constexpr Range physical{1e-12, 1e12};
inline constexpr Range physical_or_zero{1e-12, 1e12, true, true};

/// A text without spaces at its ends.
inline std::string_view trimmed(std::string_view text) {
  while (text.starts_with(' ')) text.remove_prefix(1);
  while (text.ends_with(' ')) text.remove_suffix(1);
  return text;
}

/// Takes a number, which may have a leading +, and the spaces around it from the start of a text.
/// Returns whether there is one; otherwise text and number are unspecified.
template <class Number>
bool take_number(std::string_view& text, Number& number) {
  text = trimmed(text);
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  text = trimmed(text.substr(static_cast<std::size_t>(end - text.data())));
  return error == std::errc();
}

/// Whether the whole text is a number, with or without spaces around it; otherwise `number` is
/// unspecified.
template <class Number>
bool parse_number(std::string_view text, Number& number) {
  return take_number(text, number) && text.empty();
}

/// first + n * step, rounded to 15 digits, so that 0.51 is the same number here, as a single value
/// in a job file, and in ds.sel(r1=0.51).
double rounded_sum(double first, std::size_t n, double step);

/// The value of a key as a duration in seconds: 90, 1:30, 2:00:00 or 1-12:00:00. Throws InputError
/// if it is not a duration above 0, or a part is as long as the unit of the part before it.
double to_seconds(const std::string& key, const std::string& value);

/// A size as "1.2 GB", "34.5 MB" or "678 bytes".
std::string size_text(std::uintmax_t bytes);

/// A UDUNITS string in common notation: "m/s" for "m s-1", and nothing for "1".
std::string unit_text(std::string_view units);

}  // namespace trebsweep
