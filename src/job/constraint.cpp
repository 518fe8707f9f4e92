#include "trebsweep/job/constraint.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/algorithm/string/trim.hpp>
#include <cmath>
#include <vector>

#include "trebsweep/job/unit.hpp"

namespace trebsweep {

std::vector<Field> fields_of(const std::vector<Constraint>& constraints) {
  std::vector<Field> fields;
  for (const auto& [expression, is_upper, limit] : constraints)
    fields.insert(fields.end(), expression.fields.begin(), expression.fields.end());
  return fields;
}

std::string to_text(const Constraint& constraint) {
  return fmt::format("{} {} {}", constraint.expression.text,
                     constraint.is_upper ? "<=" : ">=", constraint.limit);
}

Constraint to_constraint(const std::string& key, const std::string& text) {
  const auto check = [&](bool valid, const std::string& why) {
    if (!valid) refuse(key, text, "FIELD <= NUMBER or FIELD >= NUMBER, " + why);
  };
  const auto sign = std::min(text.find("<="), text.find(">="));
  check(sign != text.npos, "with the sign <= or >=, which includes the limit");
  const auto expression = to_expression(text.substr(0, sign));
  check(expression.has_value(), "where FIELD is " + allowed_expressions());
  const std::string number = boost::trim_copy(text.substr(sign + 2));
  const std::string& unit = expression->unit;
  const auto limit = to_si(number, unit);
  check(limit && std::isfinite(*limit), "where NUMBER is finite" + allowed_units(number, unit));
  return {*expression, text[sign] == '<', *limit};
}

}  // namespace trebsweep
