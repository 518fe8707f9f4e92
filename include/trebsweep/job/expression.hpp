#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "trebsweep/model/scene.hpp"
#include "trebsweep/swing/field.hpp"

namespace trebsweep {

/// What expressions are evaluated for: a design in a scene, with the values of some fields.
struct Operands {
  const Scene& scene;
  const Design<double>& design;
  std::span<const Field> fields;
  std::span<const double> values;  ///< of the fields
};

/// The value of a field among those of the operands; NaN if it is not one of them.
double value_of(const Operands& operands, Field field);

/// A formula of fields that are quantities, the lengths r1, r2 and r3, and numeric keys of the
/// scene, as in "peak-axle-load / counterweight-mass".
struct Expression {
  std::string text;               ///< as in a job file
  std::string unit;               ///< SI unit; empty if the value has none, or it is not known
  std::vector<Field> fields;      ///< whose values it needs
  std::vector<std::string> keys;  ///< whose values it needs: "scene.gravity"
  bool is_constant;               ///< whether it consists of numbers only
  std::function<double(const Operands&)> value;  ///< NaN where an operand has none
};

/// The expression of a field alone.
Expression to_expression(Field field);

/// The expression with a text: sums, differences, products and quotients of operands, numbers and
/// abs(), with parentheses. Nothing if it is not one, is_constant, or has more than 1000
/// characters.
std::optional<Expression> to_expression(std::string_view text);

}  // namespace trebsweep
