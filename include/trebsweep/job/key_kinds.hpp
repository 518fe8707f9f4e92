#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "trebsweep/base/number.hpp"
#include "trebsweep/job/constraint.hpp"
#include "trebsweep/job/expression.hpp"
#include "trebsweep/job/lattice.hpp"
#include "trebsweep/job/unit.hpp"
#include "trebsweep/job/variable.hpp"

namespace trebsweep {

/// A kind of keys: how the text of a value is parsed and printed.
template <class T>
struct KeyKind {
  std::string placeholder;  ///< of a value, in help: "NUMBER"
  std::string allowed;      ///< the values allowed, for help
  /// The value of the text given for a key. Throws InputError naming the key, the text and what is
  /// allowed.
  std::function<T(const std::string& key, const std::string& text)> parse;
  /// The text that parses to a value; empty for a value that is not set.
  std::function<std::string(const T&)> print;
  std::string unit = {};  ///< of a number: "kg"; empty if it has none
};

/// A number in a unit, or in another one of the same dimension that its text names.
KeyKind<double> number(const Range& range, const std::string& unit = "");

/// A number that may be omitted; it is then 0.
KeyKind<double> optional_number(const Range& range, const std::string& unit);

/// An axis as first:last:step or as a single value, m.
KeyKind<AxisRange> axis_range();

/// A path that survives being written to a job file and read back.
KeyKind<std::string> path();

/// A list of paths, possibly empty.
KeyKind<std::vector<std::string>> paths();

/// One of the names.
KeyKind<std::string> choice(std::span<const std::string_view> names);

/// yes or no.
KeyKind<bool> yes_no();

/// Variables of a search.
KeyKind<std::vector<Variable>> variables();

/// An expression of at least one field.
KeyKind<Expression> expression();

/// A list of constraints, separated by commas, possibly empty.
KeyKind<std::vector<Constraint>> constraints();

/// The range of a text first:last:step, whose ends `parse` reads and checks, in a unit. Throws
/// InputError, naming `alternative` as what else the key allows, also if no number of steps reaches
/// the last value.
AxisRange to_range(const std::string& key, const std::string& text, const std::string& unit,
                   const std::function<double(const std::string&)>& parse,
                   const std::string& alternative);

/// The text first:last:step.
std::string to_text(const AxisRange& range);

/// The words of a list, separated by commas, spaces or both.
std::vector<std::string> to_words(const std::string& text);

/// The values of a list of numbers, separated like words; those with a unit by commas.
std::vector<std::string> to_values(const std::string& text);

/// The position of a text among the names. Throws InputError if it is not one of them.
std::size_t to_index(const std::string& key, const std::string& text,
                     std::span<const std::string_view> names);

template <class Integer>
KeyKind<Integer> integer(std::uint64_t low, std::uint64_t high) {
  const std::string allowed = fmt::format("an integer from {} to {}", low, high);
  return {"INTEGER", allowed,
          [=](const std::string& key, const std::string& text) {
            std::uint64_t n = 0;
            if (!parse_number(text, n) || n < low || n > high) refuse(key, text, allowed);
            return static_cast<Integer>(n);
          },
          [](const Integer& n) { return fmt::format("{}", n); }};
}

/// One value of an enumeration; `names` are in the order of its values.
template <class Enum>
KeyKind<Enum> choice(std::span<const std::string_view> names) {
  return {"NAME", fmt::format("one of {}", fmt::join(names, ", ")),
          [=](const std::string& key, const std::string& text) {
            return static_cast<Enum>(to_index(key, text, names));
          },
          [=](const Enum& value) { return std::string(names[static_cast<std::size_t>(value)]); }};
}

/// A value without a default.
template <class T>
KeyKind<std::optional<T>> optional_of(const KeyKind<T>& kind) {
  return {kind.placeholder, kind.allowed, kind.parse,
          [=](const std::optional<T>& value) { return value ? kind.print(*value) : ""; },
          kind.unit};
}

/// A list of at least one value.
template <class T>
KeyKind<std::vector<T>> list_of(const KeyKind<T>& element) {
  return {"LIST", "a list, each " + element.allowed,
          [=](const std::string& key, const std::string& text) {
            std::vector<T> values;
            const auto words = element.unit.empty() ? to_words(text) : to_values(text);
            if (!element.unit.empty()) check_units_agree(key, text, words);
            for (const std::string& word : words) values.push_back(element.parse(key, word));
            return values;
          },
          [=](const std::vector<T>& values) {
            std::vector<std::string> words;
            for (const T& value : values) words.push_back(element.print(value));
            return fmt::format("{}", fmt::join(words, ", "));
          },
          element.unit};
}

/// A list of at least one value, without repetitions.
template <class T>
KeyKind<std::vector<T>> set_of(const KeyKind<T>& element) {
  KeyKind<std::vector<T>> kind = list_of(element);
  kind.parse = [=, parse_list = kind.parse](const std::string& key, const std::string& text) {
    const std::vector<T> values = parse_list(key, text);
    for (auto value = values.begin(); value != values.end(); ++value)
      if (std::find(values.begin(), value, *value) != value)
        refuse(key, element.print(*value), "listed only once");
    return values;
  };
  return kind;
}

}  // namespace trebsweep
