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

/// The field with a name, if there is one that is_quantity().
std::optional<Field> to_quantity(std::string_view name);

/// The names of the fields that are quantities, separated by commas.
std::string quantity_names();

/// The value of an expression, NaN where an operand has none, and its magnitude: |value|, except
/// that of a sum the largest magnitude of its terms, where the value may be close to zero.
struct Amount {
  double value, magnitude;
};

/// A formula of fields that are quantities, the lengths r1, r2 and r3, and numeric keys of the
/// scene, as in "peak-axle-load / counterweight-mass".
struct Expression {
  std::string text;               ///< as in a job file
  std::string unit;               ///< SI unit; empty if the value has none, or it is not known
  std::vector<Field> fields;      ///< whose values it needs
  std::vector<std::string> keys;  ///< whose values it needs: "scene.gravity"
  bool is_constant;               ///< whether it consists of numbers only
  int distance;                   ///< 1 for an abs(), -1 for its negative, else 0
  std::function<Amount(const Operands&)> amount;

  double value(const Operands& operands) const { return amount(operands).value; }
};

/// The expression of a field alone.
Expression to_expression(Field field);

/// The field that an expression is, or nothing for a formula.
std::optional<Field> field_of(const Expression& expression);

/// What the value of an expression is, in words: the meaning of a field, or the formula.
std::string_view meaning(const Expression& expression);

/// The expression with the opposite sign.
Expression negative(const Expression& expression);

/// An objective as it is shown: -(X) as the least X, whose values have the opposite sign.
struct ShownObjective {
  std::string text;
  double sign;               ///< by which values are multiplied: 1 or -1
  std::string_view extreme;  ///< "largest" or "least"
};

ShownObjective shown(const Expression& objective);

/// The expression with a text: sums, differences, products and quotients of operands, numbers and
/// abs(), with parentheses. Nothing if it is not one, is_constant, or has more than 1000
/// characters.
std::optional<Expression> to_expression(std::string_view text);

/// What to_expression() accepts, for messages.
std::string allowed_expressions();

}  // namespace trebsweep
