#include "trebsweep/job/expression.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <boost/algorithm/string/trim_all.hpp>
#include <boost/spirit/home/x3.hpp>
#include <cmath>
#include <limits>
#include <vector>

#include "trebsweep/job/key.hpp"
#include "trebsweep/job/unit.hpp"

namespace trebsweep {
namespace {

namespace x3 = boost::spirit::x3;

using Value = std::function<double(const Operands&)>;

/// The amount of a single operand.
Amount amount_of(double value) { return {value, std::abs(value)}; }

Expression operand(const std::string& name, const std::string& unit, const Value& value) {
  return {name, unit, {}, {}, false, false, [=](const Operands& x) { return amount_of(value(x)); }};
}

Expression constant(double number) {
  return {"", "", {}, {}, true, 0, [=](const Operands&) { return amount_of(number); }};
}

// The operations of expressions.
Amount sum_of(const Amount& a, const Amount& b) {
  return {a.value + b.value, std::max(a.magnitude, b.magnitude)};
}
Amount difference_of(const Amount& a, const Amount& b) {
  return sum_of(a, {-b.value, b.magnitude});
}
Amount product_of(const Amount& a, const Amount& b) {
  return {a.value * b.value, a.magnitude * b.magnitude};
}
Amount quotient_of(const Amount& a, const Amount& b) {
  return {a.value / b.value, a.magnitude / std::abs(b.value)};
}

/// Whether a sum has terms of which one is a number with another unit than the other's.
bool has_wrong_unit(const Expression& a, const Expression& b) {
  return (a.is_constant || b.is_constant) && !a.unit.empty() && !b.unit.empty() && a.unit != b.unit;
}

/// The unit of a sum or, if it does not keep units, of a product. A number without a unit takes
/// that of the other operand.
std::string joined_unit(const Expression& a, const Expression& b, bool keeps_unit) {
  if (a.is_constant && a.unit.empty()) return b.unit;
  if (b.is_constant && b.unit.empty()) return a.unit;
  return keeps_unit && a.unit == b.unit ? a.unit : "";
}

/// Two expressions joined by an operation.
Expression joined(Expression a, const Expression& b, bool keeps_unit,
                  Amount operation(const Amount&, const Amount&)) {
  a.unit = joined_unit(a, b, keeps_unit);
  a.is_constant = a.is_constant && b.is_constant;
  a.distance = 0;
  a.fields.insert(a.fields.end(), b.fields.begin(), b.fields.end());
  a.keys.insert(a.keys.end(), b.keys.begin(), b.keys.end());
  a.amount = [=, f = a.amount, g = b.amount](const Operands& x) { return operation(f(x), g(x)); };
  return a;
}

/// An expression with its amount changed, such as its sign.
Expression mapped(Expression a, Amount operation(const Amount&)) {
  a.amount = [=, f = a.amount](const Operands& x) { return operation(f(x)); };
  return a;
}

Expression with_opposite_sign(Expression a) {
  a = mapped(a, [](const Amount& x) { return Amount{-x.value, x.magnitude}; });
  a.distance = -a.distance;
  return a;
}

Amount distance_of(const Amount& a) { return {std::abs(a.value), a.magnitude}; }

/// The operands by their names, of which the longest that fits is taken: names contain hyphens.
x3::symbols<Expression> operand_names() {
  x3::symbols<Expression> names;
  for (const FieldInfo& field : field_info)
    if (is_quantity(field.field)) names.add(std::string(field.name), to_expression(field.field));
  names.add("r1", operand("r1", "m", [](const Operands& x) { return x.design.r1; }));
  names.add("r2", operand("r2", "m", [](const Operands& x) { return x.design.r2; }));
  names.add("r3", operand("r3", "m", [](const Operands& x) { return x.design.r3; }));
  for (const Key& key : job_keys()) {
    if (!key.number) continue;
    const std::string name = key.name.substr(key.name.find('.') + 1);
    Expression of_key =
        operand(name, key.unit, [&key](const Operands& x) { return key.number(x.scene); });
    of_key.keys = {key.name};
    if (!names.find(name)) names.add(name, of_key);  // sling-angle is a field
  }
  return names;
}

x3::symbols<Unit> unit_symbols() {
  x3::symbols<Unit> symbols;
  for (const NamedUnit& named : named_units()) symbols.add(std::string(named.name), named.unit);
  return symbols;
}

/// Numbers without "nan" and "inf".
struct FinitePolicies : x3::real_policies<double> {
  template <class Iterator, class Attribute>
  static bool parse_nan(Iterator&, const Iterator&, Attribute&) {
    return false;
  }
  template <class Iterator, class Attribute>
  static bool parse_inf(Iterator&, const Iterator&, Attribute&) {
    return false;
  }
};
const x3::real_parser<double, FinitePolicies> finite_number;

/// Sets the attribute of a rule, or joins it with another one.
const auto set = [](auto& context) { x3::_val(context) = x3::_attr(context); };
const auto set_number = [](auto& context) { x3::_val(context) = constant(x3::_attr(context)); };

const auto set_unit = [](auto& context) {
  const Unit unit = x3::_attr(context);
  Expression& number = x3::_val(context);
  number.unit = si_unit(unit);
  number.amount = [=, f = number.amount](const Operands& x) {
    return amount_of(f(x).value * unit.factor);
  };
};

const auto add = [](auto& context) {
  x3::_pass(context) = !has_wrong_unit(x3::_val(context), x3::_attr(context));
  x3::_val(context) = joined(x3::_val(context), x3::_attr(context), true, sum_of);
};
const auto subtract = [](auto& context) {
  x3::_pass(context) = !has_wrong_unit(x3::_val(context), x3::_attr(context));
  x3::_val(context) = joined(x3::_val(context), x3::_attr(context), true, difference_of);
};
const auto multiply = [](auto& context) {
  x3::_val(context) = joined(x3::_val(context), x3::_attr(context), false, product_of);
};
const auto divide = [](auto& context) {
  const bool is_reciprocal = x3::_val(context).is_constant;
  x3::_val(context) = joined(x3::_val(context), x3::_attr(context), false, quotient_of);
  if (is_reciprocal) x3::_val(context).unit = "";
};
const auto negate = [](auto& context) {
  x3::_val(context) = with_opposite_sign(x3::_attr(context));
};
const auto set_distance = [](auto& context) {
  x3::_val(context) = mapped(x3::_attr(context), distance_of);
  x3::_val(context).distance = 1;
};

const x3::rule<struct SumOf, Expression> sum = "sum";
const x3::rule<struct ProductOf, Expression> product = "product";
const x3::rule<struct FactorOf, Expression> factor = "factor";

const auto sum_def = product[set] >> *(('+' >> product[add]) | ('-' >> product[subtract]));
const auto product_def = factor[set] >> *(('*' >> factor[multiply]) | ('/' >> factor[divide]));
const auto factor_def = (x3::lit("abs") >> '(' >> sum[set_distance] >> ')') |
                        ('(' >> sum[set] >> ')') | ('-' >> factor[negate]) | operand_names()[set] |
                        (finite_number[set_number] >> -unit_symbols()[set_unit]);
BOOST_SPIRIT_DEFINE(sum, product, factor)

}  // namespace

double value_of(const Operands& operands, Field field) {
  const auto found = std::ranges::find(operands.fields, field);
  return found == operands.fields.end()
             ? std::numeric_limits<double>::quiet_NaN()
             : operands.values[static_cast<std::size_t>(found - operands.fields.begin())];
}

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

Expression to_expression(Field field) {
  const FieldInfo& known = info(field);
  Expression expression = operand(std::string(known.name), std::string(known.units),
                                  [=](const Operands& x) { return value_of(x, field); });
  expression.fields = {field};
  return expression;
}

std::optional<Field> field_of(const Expression& expression) { return to_quantity(expression.text); }

std::string_view meaning(const Expression& expression) {
  const auto field = field_of(expression);
  return field ? info(*field).meaning : std::string_view(expression.text);
}

Expression negative(const Expression& expression) {
  Expression opposite = with_opposite_sign(expression);
  opposite.text = "-(" + expression.text + ")";
  return opposite;
}

ShownObjective shown(const Expression& objective) {
  const std::string& text = objective.text;
  const ShownObjective as_given{text, 1, "largest"};
  if (!text.starts_with("-(") || !text.ends_with(")")) return as_given;
  int depth = 0;
  for (const char c : text.substr(1, text.size() - 2)) {
    depth += c == '(' ? 1 : c == ')' ? -1 : 0;
    if (depth == 0) return as_given;  // as in -(a) + (b)
  }
  return {text.substr(2, text.size() - 3), -1, "least"};
}

std::optional<Expression> to_expression(std::string_view text) {
  constexpr std::size_t longest = 1000;  // nested parentheses are parsed by recursion
  const auto is_ascii = [](char c) { return static_cast<unsigned char>(c) < 128; };
  if (text.size() > longest || !std::ranges::all_of(text, is_ascii)) return std::nullopt;
  Expression expression;
  auto begin = text.begin();
  if (!x3::phrase_parse(begin, text.end(), sum, x3::space, expression) || begin != text.end() ||
      expression.is_constant)
    return std::nullopt;
  expression.text = boost::trim_all_copy(std::string(text));
  return expression;
}

std::string allowed_expressions() {
  return "one of " + quantity_names() +
         ", or a formula with + - * / ( ) abs() of these, r1, r2, r3, numeric keys of [scene] and "
         "numbers with or without a unit";
}

}  // namespace trebsweep
