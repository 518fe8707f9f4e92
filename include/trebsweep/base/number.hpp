#pragma once

#include <charconv>
#include <limits>
#include <string>
#include <string_view>

namespace trebsweep {

/// A user's text for a message, cut after 200 characters.
std::string shortened(const std::string& text);

/// A text on one line, without control characters, which a terminal would obey.
std::string printable(std::string text);

/// Refuses a key's value. Throws InputError: "key = value: must be allowed".
[[noreturn]] void refuse(const std::string& key, const std::string& value,
                         const std::string& allowed);

/// The finite numbers that a key takes.
struct Range {
  double low;
  double high = std::numeric_limits<double>::infinity();
  bool ends_allowed = true;   ///< whether `low` and a finite `high` belong to it
  bool zero_allowed = false;  ///< whether 0 does, in addition

  bool contains(double x) const;
  std::string text() const;  ///< "a finite number above 0"
};

inline constexpr Range positive{0, std::numeric_limits<double>::infinity(), false};
inline constexpr Range not_negative{0};

/// Physical quantities in SI units: beyond these magnitudes the arithmetic loses its meaning before
/// it overflows.
inline constexpr Range physical{1e-12, 1e12};
inline constexpr Range physical_or_zero{1e-12, 1e12, true, true};

/// Whether the whole text, but for blanks around it and a leading +, is a number, which it then
/// becomes.
template <class Number>
bool parses(std::string_view text, Number& number) {
  while (text.starts_with(' ')) text.remove_prefix(1);
  while (text.ends_with(' ')) text.remove_suffix(1);
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() && end == text.data() + text.size();
}

/// The number that a key's value says. Throws InputError if it is none, or outside the range.
double to_number(const std::string& key, const std::string& value, const Range& range);

/// The seconds that a key's value says: 90, 1:30, 2:00:00 or 1-12:00:00. Throws InputError if it
/// says none.
double to_seconds(const std::string& key, const std::string& value);

}  // namespace trebsweep
