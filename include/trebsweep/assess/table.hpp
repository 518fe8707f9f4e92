#pragma once

#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "trebsweep/archive/hdf5.hpp"

namespace trebsweep {

/// A column of a table: a name, a unit (UDUNITS; empty for none), a meaning and its values.
struct Column {
  std::string name, units, meaning;
  std::variant<std::vector<double>, std::vector<std::string>> values;
  bool printed = true;  ///< else it is in the file alone
  int digits = 3;       ///< of numbers, in print
};

/// Columns of one length.
struct Table {
  std::string name, meaning;
  std::vector<Column> columns;

  std::size_t rows() const;
};

/// The table's printed columns as aligned text, with a title; nothing of a table without any.
std::string to_text(const Table& table);

/// Writes the table as a group of its name: a dataset per column along the dimension `row`. Throws
/// std::runtime_error where HDF5 fails.
void write(const hdf5::File& file, const Table& table);

}  // namespace trebsweep
