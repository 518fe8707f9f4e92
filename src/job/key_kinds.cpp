#include "trebsweep/job/key_kinds.hpp"

#include <algorithm>
#include <boost/algorithm/string.hpp>
#include <cmath>

#include "trebsweep/job/unit.hpp"

namespace trebsweep {
namespace {

/// Whether a path survives being written to a job file, where a # starts a comment.
bool is_readable_back(const std::string& path) {
  return !path.empty() && path == boost::trim_copy(path) &&
         path.find_first_of("#\n\r\"") == std::string::npos;
}

[[noreturn]] void refuse_range(const std::string& key, const std::string& text,
                               const std::string& alternative) {
  refuse(key, text, "first:last:step with a step above 0 and first <= last, or " + alternative);
}

AxisRange to_axis(const std::string& key, const std::string& text) {
  const std::string value = "a single value, in metres, each from 1e-12 to 1e+12";
  const auto parse = [&](const std::string& part) {
    const auto x = to_si(part, "m");
    if (!x || !physical.contains(*x)) refuse_range(key, text, value);
    return *x;
  };
  if (text.find(':') != text.npos) return to_range(key, text, "m", parse, value);
  const double x = parse(text);
  return {x, x, 1};
}

/// Throws InputError unless stepping from the first value of a range reaches its last one.
void check_steps(const std::string& key, const std::string& text, const AxisRange& range) {
  const double steps = (range.last - range.first) / range.step;
  // In steps: decimals are rounded to doubles, relative to the magnitude of the last value.
  const double rounding_allowance = 1e-9 + 1e-15 * std::abs(range.last) / range.step;
  if (std::abs(steps - std::round(steps)) <= rounding_allowance) return;
  const auto value_after = [&](double n) { return range.first + n * range.step; };
  refuse(key, text,
         fmt::format("a range whose last value is an integer number of steps from the first; the "
                     "nearest are {:.15g} and {:.15g}",
                     value_after(std::floor(steps)), value_after(std::ceil(steps))));
}

/// A list whose items are separated by commas.
template <class Item>
KeyKind<std::vector<Item>> comma_list(const std::string& allowed,
                                      Item to_item(const std::string&, const std::string&)) {
  return {"LIST", allowed,
          [=](const std::string& key, const std::string& text) {
            std::vector<Item> items;
            if (boost::trim_copy(text).empty()) return items;
            std::vector<std::string> parts;
            boost::split(parts, text, boost::is_any_of(","));
            for (const std::string& part : parts)
              items.push_back(to_item(key, boost::trim_copy(part)));
            return items;
          },
          [](const std::vector<Item>& items) {
            std::vector<std::string> parts;
            for (const Item& item : items) parts.push_back(to_text(item));
            return fmt::format("{}", fmt::join(parts, ", "));
          }};
}

}  // namespace

AxisRange to_range(const std::string& key, const std::string& text, const std::string& unit,
                   const std::function<double(const std::string&)>& parse,
                   const std::string& alternative) {
  std::vector<std::string> parts;
  boost::split(parts, text, boost::is_any_of(":"));
  for (std::string& part : parts) boost::trim(part);
  if (parts.size() != 3 || std::ranges::count(parts, "") > 0 || text.find(',') != text.npos)
    refuse_range(key, text, alternative);
  check_units_agree(key, text, parts);
  const auto step = to_si(parts[2], unit);
  if (!step || !(*step > 0) || !std::isfinite(*step)) refuse_range(key, text, alternative);
  const AxisRange range{parse(parts[0]), parse(parts[1]), *step};
  if (range.first > range.last) refuse_range(key, text, alternative);
  check_steps(key, text, range);
  return range;
}

std::string to_text(const AxisRange& range) {
  return fmt::format("{}:{}:{}", range.first, range.last, range.step);
}

std::vector<std::string> to_words(const std::string& text) {
  std::vector<std::string> words;
  boost::split(words, boost::trim_copy(text), boost::is_any_of(", "), boost::token_compress_on);
  return words;
}

std::vector<std::string> to_values(const std::string& text) {
  std::vector<std::string> parts, values;
  boost::split(parts, text, boost::is_any_of(","));
  for (const std::string& part : parts) {
    const std::vector<std::string> words = to_words(part);
    double number = 0;
    const auto is_number = [&](const std::string& word) { return parse_number(word, number); };
    if (std::ranges::all_of(words, is_number))
      values.insert(values.end(), words.begin(), words.end());
    else
      values.push_back(boost::trim_copy(part));
  }
  return values;
}

std::size_t to_index(const std::string& key, const std::string& text,
                     std::span<const std::string_view> names) {
  const auto found = std::find(names.begin(), names.end(), text);
  if (found == names.end()) refuse(key, text, fmt::format("one of {}", fmt::join(names, ", ")));
  return static_cast<std::size_t>(found - names.begin());
}

KeyKind<double> number(const Range& range, const std::string& unit) {
  return {"NUMBER", range.text(),
          [=](const std::string& key, const std::string& text) {
            return to_number(key, text, range, unit);
          },
          [](const double& x) { return fmt::format("{}", x); }, unit};
}

KeyKind<double> optional_number(const Range& range, const std::string& unit) {
  KeyKind<double> kind = number(range, unit);
  kind.print = [](const double& x) { return x > 0 ? fmt::format("{}", x) : ""; };
  return kind;
}

KeyKind<AxisRange> axis_range() {
  return {"RANGE", "first:last:step, including both ends, or a single value", to_axis,
          [](const AxisRange& axis) {
            return axis.first == axis.last ? fmt::format("{}", axis.first) : to_text(axis);
          },
          "m"};
}

KeyKind<std::string> path() {
  const std::string allowed =
      "a path without #, quotes or line breaks, and without spaces at its ends";
  return {"PATH", allowed,
          [=](const std::string& key, const std::string& text) {
            if (!is_readable_back(text)) refuse(key, text, allowed);
            return text;
          },
          [](const std::string& text) { return text; }};
}

KeyKind<std::vector<std::string>> paths() {
  return {"LIST", "a list of paths without #, quotes or spaces",
          [](const std::string& key, const std::string& text) {
            std::vector<std::string> paths;
            for (const std::string& word : to_words(text)) {
              if (word.empty()) continue;
              if (!is_readable_back(word)) refuse(key, word, "a path without # or quotes");
              paths.push_back(word);
            }
            return paths;
          },
          [](const std::vector<std::string>& paths) {
            return fmt::format("{}", fmt::join(paths, ", "));
          }};
}

KeyKind<std::string> choice(std::span<const std::string_view> names) {
  return {"NAME", fmt::format("one of {}", fmt::join(names, ", ")),
          [=](const std::string& key, const std::string& text) {
            return std::string(names[to_index(key, text, names)]);
          },
          [](const std::string& name) { return name; }};
}

KeyKind<bool> yes_no() {
  static constexpr std::array<std::string_view, 2> names{"no", "yes"};
  return choice<bool>(names);
}

KeyKind<Expression> expression() {
  return {"FIELD", allowed_expressions(),
          [](const std::string& key, const std::string& text) {
            const auto expression = to_expression(text);
            if (!expression) refuse(key, text, allowed_expressions());
            if (expression->fields.empty())
              refuse(key, text, "a formula with a field: with " + allowed_expressions());
            return *expression;
          },
          [](const Expression& expression) { return expression.text; }};
}

KeyKind<std::vector<Constraint>> constraints() {
  return comma_list(
      "a list, each FIELD <= NUMBER or FIELD >= NUMBER, separated by commas, where FIELD is as "
      "for objective, or a formula without fields",
      to_constraint);
}

KeyKind<std::vector<Variable>> variables() {
  return comma_list(
      fmt::format("a list of up to {}, each KEY LOW:HIGH, separated by commas, where KEY is a "
                  "numeric key of [scene], pin-angle or release-angle",
                  max_variables),
      to_variable);
}

}  // namespace trebsweep
