#include "trebsweep/job/unit.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <boost/math/constants/constants.hpp>
#include <cmath>
#include <vector>

namespace trebsweep {
namespace {

constexpr std::array none{0, 0, 0, 0};
constexpr std::array mass{1, 0, 0, 0}, length{0, 1, 0, 0}, time{0, 0, 1, 0}, angle{0, 0, 0, 1};
constexpr std::array speed{0, 1, -1, 0}, force{1, 1, -2, 0}, pressure{1, -1, -2, 0};
constexpr std::array energy{1, 2, -2, 0};

// The international yard and pound (1959) and standard gravity (CGPM 1901), which are exact.
constexpr double inch = 0.0254, foot = 0.3048, yard = 0.9144, mile = 1609.344;
constexpr double pound = 0.45359237, pound_force = pound * 9.80665;
constexpr double psi = pound_force / (inch * inch);
constexpr double degree = boost::math::double_constants::degree;

constexpr auto units = std::to_array<NamedUnit>({
    {"kg", {1, mass}},
    {"g", {1e-3, mass}},
    {"t", {1e3, mass}},
    {"lb", {pound, mass}},
    {"lbs", {pound, mass}},
    {"oz", {pound / 16, mass}},
    {"m", {1, length}},
    {"mm", {1e-3, length}},
    {"cm", {1e-2, length}},
    {"km", {1e3, length}},
    {"in", {inch, length}},
    {"ft", {foot, length}},
    {"yd", {yard, length}},
    {"mi", {mile, length}},
    {"s", {1, time}},
    {"ms", {1e-3, time}},
    {"min", {60, time}},
    {"h", {3600, time}},
    {"rad", {1, angle}},
    {"mrad", {1e-3, angle}},
    {"deg", {degree, angle}},
    {"arcmin", {degree / 60, angle}},
    {"mph", {mile / 3600, speed}},
    {"kph", {1000.0 / 3600, speed}},
    {"fps", {foot, speed}},
    {"kn", {1852.0 / 3600, speed}},
    {"N", {1, force}},
    {"kN", {1e3, force}},
    {"MN", {1e6, force}},
    {"lbf", {pound_force, force}},
    {"kgf", {9.80665, force}},
    {"Pa", {1, pressure}},
    {"kPa", {1e3, pressure}},
    {"MPa", {1e6, pressure}},
    {"GPa", {1e9, pressure}},
    {"bar", {1e5, pressure}},
    {"psi", {psi, pressure}},
    {"ksi", {1e3 * psi, pressure}},
    {"J", {1, energy}},
    {"kJ", {1e3, energy}},
    {"%", {1e-2, none}},
});

bool is_letter(char c) { return ('a' <= c && c <= 'z') || ('A' <= c && c <= 'Z') || c == '%'; }

/// Takes a named unit from the start of a text.
std::optional<Unit> take_name(std::string_view& text) {
  const auto end = std::ranges::find_if_not(text, is_letter);
  const auto size = static_cast<std::size_t>(end - text.begin());
  const auto found = std::ranges::find(units, text.substr(0, size), &NamedUnit::name);
  text.remove_prefix(size);
  return found == units.end() ? std::nullopt : std::optional(found->unit);
}

/// Takes an exponent such as "^2", "2" or "-1" from the start of a text. Without an exponent, it is
/// 1; nothing if the exponent is invalid.
std::optional<int> take_exponent(std::string_view& text) {
  const bool is_marked = text.starts_with('^');
  if (is_marked) text.remove_prefix(1);
  const bool is_given =
      text.starts_with('-') || (!text.empty() && '0' <= text[0] && text[0] <= '9');
  if (!is_given) return is_marked ? std::nullopt : std::optional(1);
  int exponent = 0;
  constexpr int largest = 9;
  if (!take_number(text, exponent) || std::abs(exponent) > largest) return std::nullopt;
  return exponent;
}

Unit product(Unit a, const Unit& b, int exponent) {
  for (int i = 0; i < std::abs(exponent); ++i)
    a.factor = exponent > 0 ? a.factor * b.factor : a.factor / b.factor;
  for (std::size_t i = 0; i < a.dimension.size(); ++i) a.dimension[i] += exponent * b.dimension[i];
  return a;
}

/// The decimal number of 15 digits from which a product differs by rounding only, or the product:
/// 1.5 in are 0.0381 m.
double without_rounding(double product) {
  const double decimal = rounded_sum(0, 1, product);
  return std::abs(decimal - product) < 2.2e-16 * std::abs(product) ? decimal : product;
}

/// What follows the number in a text, if it starts like a unit.
std::string_view unit_of(std::string_view text) {
  double number = 0;
  const bool has_unit = take_number(text, number) && !text.empty() && is_letter(text[0]);
  return has_unit ? text : "";
}

/// The inches in the unit's text of a length such as 4 "ft 3 in"; nothing if it is not one.
std::optional<double> inches_of(std::string_view text) {
  double inches = 0;
  if (!text.starts_with("ft ")) return std::nullopt;
  text.remove_prefix(3);
  const bool is_length = take_number(text, inches) && text == "in" && inches >= 0 && inches < 12;
  return is_length ? std::optional(inches) : std::nullopt;
}

/// The dimension of the unit with a text; no dimension if the text is empty.
std::optional<std::array<int, 4>> dimension_of(std::string_view unit) {
  if (unit.empty() || unit == "1") return none;
  const auto found = to_unit(unit);
  return found ? std::optional(found->dimension) : std::nullopt;
}

}  // namespace

std::span<const NamedUnit> named_units() { return units; }

std::string si_unit(const Unit& unit) {
  for (const NamedUnit& named : units)
    if (named.unit.factor == 1 && named.unit.dimension == unit.dimension)
      return std::string(named.name);
  constexpr std::array names{"kg", "m", "s", "rad"};
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const int exponent = unit.dimension[i];
    if (exponent == 0) continue;
    text += fmt::format("{}{}{}", text.empty() ? "" : " ", names[i],
                        exponent == 1 ? "" : fmt::format("{}", exponent));
  }
  return text;
}

ShownUnit shown_unit(std::string_view unit, UnitSystem system) {
  using Names = std::pair<std::string_view, std::string_view>;  // in the SI, and customary
  constexpr std::array customary{Names{"m", "ft"}, Names{"m/s", "mph"}, Names{"N", "lbf"},
                                 Names{"Pa", "psi"}, Names{"kg", "lb"}};
  const std::string text = unit_text(unit);
  const auto of = [](std::string_view name) {
    return ShownUnit{std::string(name), to_unit(name).value().factor};
  };
  if (text == "rad" && system != UnitSystem::si) return of("deg");
  const auto found = std::ranges::find(customary, text, &Names::first);
  if (system == UnitSystem::us && found != customary.end()) return of(found->second);
  return {text, 1};
}

std::string unit_names() {
  std::vector<std::string_view> names;
  for (const NamedUnit& unit : units) names.push_back(unit.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

std::optional<Unit> to_unit(std::string_view text) {
  Unit unit{1, none};
  text = trimmed(text);
  for (bool is_divisor = false;;) {
    const auto factor = take_name(text);
    const auto exponent = take_exponent(text);
    if (!factor || !exponent) return std::nullopt;
    unit = product(unit, *factor, is_divisor ? -*exponent : *exponent);
    text = trimmed(text);
    if (text.empty()) return unit;
    is_divisor = text.starts_with('/');
    if (is_divisor || text.starts_with('*')) text = trimmed(text.substr(1));
  }
}

std::optional<double> to_si(std::string_view text, std::string_view unit) {
  double number = 0;
  if (!take_number(text, number)) return std::nullopt;
  if (text.empty()) return number;
  const auto inches = number >= 0 ? inches_of(text) : std::nullopt;
  if (inches) {
    number = 12 * number + *inches;
    text = "in";
  }
  const auto own = to_unit(text);
  if (!own || own->dimension != dimension_of(unit)) return std::nullopt;
  return without_rounding(number * own->factor);
}

std::string allowed_units(std::string_view text, std::string_view unit) {
  if (unit_of(text).empty()) return "";
  if (unit.empty() || unit == "1") return ", without a unit";
  if (to_si(text, unit)) return fmt::format(", in {}", unit);  // its range is in SI units
  std::vector<std::string_view> others;
  for (const NamedUnit& named : units)
    if (named.unit.dimension == dimension_of(unit) && named.name != unit)
      others.push_back(named.name);
  if (others.empty()) return fmt::format(", in {} or another unit of that dimension", unit);
  return fmt::format(", in one of the units {}, {}", unit, fmt::join(others, ", "));
}

double to_number(const std::string& key, const std::string& text, const Range& range,
                 std::string_view unit) {
  const auto number = to_si(text, unit);
  if (!number || !range.contains(*number))
    refuse(key, text, range.text() + allowed_units(text, unit));
  return *number;
}

void check_units_agree(const std::string& key, const std::string& text,
                       std::span<const std::string> numbers) {
  const auto has_unit = [](std::string_view number) { return !unit_of(number).empty(); };
  const auto with_unit = std::ranges::count_if(numbers, has_unit);
  if (with_unit != 0 && with_unit != std::ssize(numbers))
    refuse(key, text, "numbers of which each has a unit, or none has");
}

}  // namespace trebsweep
