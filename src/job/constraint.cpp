#include "trebsweep/job/constraint.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <boost/algorithm/string/trim.hpp>
#include <cmath>
#include <vector>

#include "trebsweep/job/unit.hpp"

namespace trebsweep {

std::optional<Field> to_quantity(std::string_view name) {
  for (const FieldInfo& info : field_info)
    if (info.name == name && is_quantity(info.field)) return info.field;
  return std::nullopt;
}

std::string quantity_names() {
  std::vector<std::string_view> names;
  for (const FieldInfo& info : field_info)
    if (is_quantity(info.field)) names.push_back(info.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

std::string to_text(const Constraint& constraint) {
  return fmt::format("{} {} {}", info(constraint.field).name,
                     constraint.is_upper ? "<=" : ">=", constraint.limit);
}

Constraint to_constraint(const std::string& key, const std::string& text) {
  const auto check = [&](bool valid, const std::string& why) {
    if (!valid) refuse(key, text, "FIELD <= NUMBER or FIELD >= NUMBER, " + why);
  };
  const auto sign = std::min(text.find("<="), text.find(">="));
  check(sign != text.npos, "with the sign <= or >=, which includes the limit");
  const auto field = to_quantity(boost::trim_copy(text.substr(0, sign)));
  check(field.has_value(), "where FIELD is one of " + quantity_names());
  const std::string number = boost::trim_copy(text.substr(sign + 2));
  const std::string_view unit = info(*field).units;
  const auto limit = to_si(number, unit);
  check(limit && std::isfinite(*limit), "where NUMBER is finite" + allowed_units(number, unit));
  return {*field, text[sign] == '<', *limit};
}

}  // namespace trebsweep
