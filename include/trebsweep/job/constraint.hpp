#pragma once

#include <string>

#include "trebsweep/swing/field.hpp"

namespace trebsweep {

/// A bound of a field, included in what is allowed.
struct Constraint {
  Field field;    ///< one that is_quantity()
  bool is_upper;  ///< field <= limit, else field >= limit
  double limit;   ///< in the unit of the field
};

/// By how much a value violates a constraint, in the unit of the field; negative where the
/// constraint holds, NaN where the value is NaN.
inline double violation(const Constraint& constraint, double value) {
  return constraint.is_upper ? value - constraint.limit : constraint.limit - value;
}

/// The constraint as in a job file: "peak-axle-load <= 150000".
std::string to_text(const Constraint& constraint);

}  // namespace trebsweep
