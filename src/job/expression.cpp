#include "trebsweep/job/expression.hpp"

#include <algorithm>
#include <boost/algorithm/string/trim_all.hpp>
#include <boost/spirit/home/x3.hpp>
#include <cmath>
#include <limits>

#include "trebsweep/job/key.hpp"

namespace trebsweep {
namespace {

namespace x3 = boost::spirit::x3;

using Value = std::function<double(const Operands&)>;

Expression operand(const std::string& name, const std::string& unit, Value value) {
  return {name, unit, {}, {}, false, std::move(value)};
}

Expression constant(double number) {
  return {"", "", {}, {}, true, [=](const Operands&) { return number; }};
}

/// Two expressions joined by an operation. A number takes the unit of the other one.
template <class Operation>
Expression joined(Expression a, const Expression& b, bool keeps_unit, Operation operation) {
  if (a.is_constant)
    a.unit = b.unit;
  else if (!b.is_constant && !(keeps_unit && a.unit == b.unit))
    a.unit = "";
  a.is_constant = a.is_constant && b.is_constant;
  a.fields.insert(a.fields.end(), b.fields.begin(), b.fields.end());
  a.keys.insert(a.keys.end(), b.keys.begin(), b.keys.end());
  a.value = [=, f = a.value, g = b.value](const Operands& x) { return operation(f(x), g(x)); };
  return a;
}

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

/// Sets the attribute of a rule, or joins it with another one.
const auto set = [](auto& context) { x3::_val(context) = x3::_attr(context); };
const auto set_number = [](auto& context) { x3::_val(context) = constant(x3::_attr(context)); };

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
const auto add = [](auto& context) {
  x3::_val(context) = joined(x3::_val(context), x3::_attr(context), true, std::plus{});
};
const auto subtract = [](auto& context) {
  x3::_val(context) = joined(x3::_val(context), x3::_attr(context), true, std::minus{});
};
const auto multiply = [](auto& context) {
  x3::_val(context) = joined(x3::_val(context), x3::_attr(context), false, std::multiplies{});
};
const auto divide = [](auto& context) {
  const bool is_reciprocal = x3::_val(context).is_constant;
  x3::_val(context) = joined(x3::_val(context), x3::_attr(context), false, std::divides{});
  if (is_reciprocal) x3::_val(context).unit = "";
};
const auto negate = [](auto& context) {
  x3::_val(context) = joined(constant(0), x3::_attr(context), true, std::minus{});
};
const auto set_magnitude = [](auto& context) {
  const auto magnitude = [](double, double x) { return std::abs(x); };
  x3::_val(context) = joined(constant(0), x3::_attr(context), true, magnitude);
};

const x3::rule<struct SumOf, Expression> sum = "sum";
const x3::rule<struct ProductOf, Expression> product = "product";
const x3::rule<struct FactorOf, Expression> factor = "factor";

const auto sum_def = product[set] >> *(('+' >> product[add]) | ('-' >> product[subtract]));
const auto product_def = factor[set] >> *(('*' >> factor[multiply]) | ('/' >> factor[divide]));
const auto factor_def = (x3::lit("abs") >> '(' >> sum[set_magnitude] >> ')') |
                        ('(' >> sum[set] >> ')') | ('-' >> factor[negate]) | operand_names()[set] |
                        finite_number[set_number];
BOOST_SPIRIT_DEFINE(sum, product, factor)

}  // namespace

double value_of(const Operands& operands, Field field) {
  const auto found = std::ranges::find(operands.fields, field);
  return found == operands.fields.end()
             ? std::numeric_limits<double>::quiet_NaN()
             : operands.values[static_cast<std::size_t>(found - operands.fields.begin())];
}

Expression to_expression(Field field) {
  const FieldInfo& known = info(field);
  Expression expression = operand(std::string(known.name), std::string(known.units),
                                  [=](const Operands& x) { return value_of(x, field); });
  expression.fields = {field};
  return expression;
}

std::optional<Expression> to_expression(std::string_view text) {
  constexpr std::size_t longest = 1000;  // nested parentheses are parsed by recursion
  if (text.size() > longest) return std::nullopt;
  Expression expression;
  auto begin = text.begin();
  if (!x3::phrase_parse(begin, text.end(), sum, x3::space, expression) || begin != text.end() ||
      expression.is_constant)
    return std::nullopt;
  expression.text = boost::trim_all_copy(std::string(text));
  return expression;
}

}  // namespace trebsweep
