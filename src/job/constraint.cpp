#include "trebsweep/job/constraint.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <boost/algorithm/string/trim.hpp>
#include <cmath>
#include <vector>

#include "trebsweep/base/number.hpp"

namespace trebsweep {
namespace {

/// The constraint with a text, if it is one.
std::optional<Constraint> parse_constraint(const std::string& text) {
  const auto sign = std::min(text.find("<="), text.find(">="));
  if (sign == text.npos) return std::nullopt;
  const auto field = to_quantity(boost::trim_copy(text.substr(0, sign)));
  double limit = 0;
  const bool is_number = parse_number(boost::trim_copy(text.substr(sign + 2)), limit);
  if (!field || !is_number || !std::isfinite(limit)) return std::nullopt;
  return Constraint{*field, text[sign] == '<', limit};
}

}  // namespace

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
  const auto constraint = parse_constraint(text);
  if (!constraint)
    refuse(key, text,
           fmt::format("FIELD <= NUMBER or FIELD >= NUMBER, where FIELD is one of {}",
                       quantity_names()));
  return *constraint;
}

}  // namespace trebsweep
