#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "trebsweep/base/number.hpp"

namespace trebsweep {

/// A unit of measurement.
struct Unit {
  double factor;                 ///< its value in SI units
  std::array<int, 4> dimension;  ///< exponents of kg, m, s and rad
};

struct NamedUnit {
  std::string_view name;
  Unit unit;
};

/// The units that a number may have; so may products of their powers.
std::span<const NamedUnit> named_units();

/// The names of named_units(), separated by commas.
std::string unit_names();

/// The unit with a text such as "ft", "km/h", "N m s/rad", "kg/m^3" or "m s-1", where / divides by
/// the next factor only; nothing if it is not a product of powers of named_units().
std::optional<Unit> to_unit(std::string_view text);

/// The unit of the SI with the dimension of another: "m" of ft, "m s-1" of mph; empty without one.
std::string si_unit(const Unit& unit);

/// The units in which numbers are shown: those of the SI, an angle in degrees as well; those that
/// are customary in the USA; or those of the SI with degrees only.
enum class UnitSystem { si, us, deg };
inline constexpr std::array<std::string_view, 3> unit_system_names{"si", "us", "deg"};

/// The unit in which a system shows numbers of a unit of the SI, and by what they are divided.
struct ShownUnit {
  std::string name;  ///< "ft"
  double factor;     ///< the unit in that of the SI
};
ShownUnit shown_unit(std::string_view unit, UnitSystem system);

/// A text that starts with a number, converted to a unit of the SI: "3.5 ft" is 1.0668 in m, and so
/// is "3 ft 6 in". Without a unit of its own, it is in that one. Nothing if it has another
/// dimension or is no number.
std::optional<double> to_si(std::string_view text, std::string_view unit);

/// The value of a key in its unit, from a number with or without a unit. Throws InputError if the
/// number is not in the range, or its unit not of that dimension.
double to_number(const std::string& key, const std::string& text, const Range& range,
                 std::string_view unit);

/// What a key with a unit allows, for a message about a text that is refused.
std::string allowed_units(std::string_view text, std::string_view unit);

/// Throws InputError if some of the numbers in a value have a unit, and others none.
void check_units_agree(const std::string& key, const std::string& text,
                       std::span<const std::string> numbers);

}  // namespace trebsweep
