#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "trebsweep/archive/hdf5.hpp"

namespace trebsweep {

/// A column of a table.
struct Column {
  std::string name;
  std::string units;    ///< UDUNITS; empty for none
  std::string meaning;  ///< CF long_name
  std::variant<std::vector<double>, std::vector<std::string>> values = {};
  bool printed = true;  ///< no: stored in the file only
  int digits = 3;       ///< significant digits of printed numbers
};

/// Columns of equal length.
struct Table {
  std::string name;
  std::string meaning;  ///< its title
  std::vector<Column> columns = {};

  std::size_t rows() const;

  /// Appends a column that has f(item) of each item as a number or a text. The result is valid
  /// until the next column is added.
  template <class Items, class F>
  Column& add_column(Column column, const Items& items, F f) {
    using Result = std::decay_t<std::invoke_result_t<F, decltype(*items.begin())>>;
    using Value = std::conditional_t<std::is_arithmetic_v<Result>, double, std::string>;
    std::vector<Value> values;
    for (const auto& item : items) values.push_back(static_cast<Value>(std::invoke(f, item)));
    column.values = std::move(values);
    return columns.emplace_back(std::move(column));
  }
};

/// The title and the printed columns as aligned text; empty if no column is printed.
std::string to_text(const Table& table);

/// Writes the table as a group with its name: a dataset per column, along the dimension `row`.
/// Throws std::runtime_error if HDF5 fails.
void write(const hdf5::File& file, const Table& table);

}  // namespace trebsweep
