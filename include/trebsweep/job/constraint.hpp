#pragma once

#include <string>
#include <vector>

#include "trebsweep/job/expression.hpp"

namespace trebsweep {

/// A bound of an expression, included in what is allowed.
struct Constraint {
  Expression expression;
  bool is_upper;  ///< expression <= limit, else expression >= limit
  double limit;   ///< in the unit of the expression
};

/// By how much a value violates a constraint, in the unit of the expression; negative where the
/// constraint holds, NaN where the value is NaN.
inline double violation(const Constraint& constraint, double value) {
  return constraint.is_upper ? value - constraint.limit : constraint.limit - value;
}

/// The fields that constraints need, one after the other.
std::vector<Field> fields_of(const std::vector<Constraint>& constraints);

/// The constraint as in a job file: "peak-axle-load <= 150000".
std::string to_text(const Constraint& constraint);

/// The constraint with a text, where spaces do not matter. Throws InputError naming the key, the
/// text and what is allowed.
Constraint to_constraint(const std::string& key, const std::string& text);

}  // namespace trebsweep
