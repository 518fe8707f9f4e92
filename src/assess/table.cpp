#include "trebsweep/assess/table.hpp"

#include <fmt/format.h>
#include <hdf5_hl.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace trebsweep {
namespace {

using hdf5::check;

std::string cell(const Column& column, std::size_t row) {
  if (const auto* texts = std::get_if<std::vector<std::string>>(&column.values))
    return (*texts)[row];
  const double value = std::get<std::vector<double>>(column.values)[row];
  return std::isnan(value) ? "-" : fmt::format("{:.{}g}", value, column.digits);
}

bool is_text(const Column& column) {
  return std::holds_alternative<std::vector<std::string>>(column.values);
}

/// Creates a dataset of n values; they are yet to be written.
hdf5::Dataset create(hid_t group, const std::string& name, hid_t type, std::size_t n) {
  const std::string what = "create column " + name;
  const hsize_t count = n;
  const hdf5::Dataspace space(H5Screate_simple(1, &count, nullptr), what);
  return {H5Dcreate2(group, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
          what};
}

void write_column(hid_t group, const Column& column, hid_t rows, std::size_t n) {
  const std::string what = "write column " + column.name;
  const hdf5::Datatype text_type = hdf5::text_type();
  const hdf5::Dataset dataset =
      create(group, column.name, is_text(column) ? text_type : hid_t{H5T_IEEE_F64LE}, n);
  if (const auto* texts = std::get_if<std::vector<std::string>>(&column.values)) {
    std::vector<const char*> pointers;
    for (const std::string& text : *texts) pointers.push_back(text.c_str());
    check(H5Dwrite(dataset, text_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, pointers.data()), what);
  } else {
    const auto& numbers = std::get<std::vector<double>>(column.values);
    check(H5Dwrite(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers.data()),
          what);
  }
  check(H5DSattach_scale(dataset, rows, 0), what);
  hdf5::write_attribute(dataset, "long_name", column.meaning);
  if (!column.units.empty()) hdf5::write_attribute(dataset, "units", column.units);
}

}  // namespace

std::size_t Table::rows() const {
  if (columns.empty()) return 0;
  return std::visit([](const auto& values) { return values.size(); }, columns.front().values);
}

std::string to_text(const Table& table) {
  const auto is_printed = [](const Column& column) { return column.printed; };
  if (std::none_of(table.columns.begin(), table.columns.end(), is_printed)) return "";
  std::string text = table.meaning + "\n";
  std::vector<std::string> lines(table.rows() + 2);
  for (const Column& column : table.columns) {
    if (!column.printed) continue;
    std::vector<std::string> cells{column.name, column.units == "1" ? "" : column.units};
    for (std::size_t row = 0; row < table.rows(); ++row) cells.push_back(cell(column, row));
    std::size_t width = 0;
    for (const std::string& c : cells) width = std::max(width, c.size());
    const char* const gap = lines[0].empty() ? "" : "  ";
    for (std::size_t i = 0; i < cells.size(); ++i)
      lines[i] += is_text(column) ? fmt::format("{}{:<{}}", gap, cells[i], width)
                                  : fmt::format("{}{:>{}}", gap, cells[i], width);
  }
  for (std::string& line : lines) {
    line.erase(line.find_last_not_of(' ') + 1);
    if (!line.empty()) text += line + "\n";  // the line of units may be empty
  }
  return text;
}

void write(const hdf5::File& file, const Table& table) {
  const std::string what = "write table " + table.name;
  const hdf5::Group group(
      H5Gcreate2(file, table.name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), what);
  hdf5::write_attribute(group, "title", table.meaning);
  const std::size_t n = table.rows();
  if (n == 0) return;
  const hdf5::Dataset rows = create(group, "row", H5T_IEEE_F64LE, n);
  std::vector<double> numbers(n);
  std::iota(numbers.begin(), numbers.end(), 0.0);
  check(H5Dwrite(rows, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers.data()), what);
  check(H5DSset_scale(rows, "row"), what);
  for (const Column& column : table.columns) write_column(group, column, rows, n);
}

}  // namespace trebsweep
