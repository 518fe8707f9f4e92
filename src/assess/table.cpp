#include "trebsweep/assess/table.hpp"

#include <fmt/format.h>
#include <hdf5_hl.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "trebsweep/base/text_table.hpp"

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

hdf5::Dataset create(hid_t group, const std::string& name, const std::vector<double>& numbers) {
  const hsize_t count = numbers.size();
  return hdf5::create_dataset(group, name, {&count, 1}, numbers);
}

hdf5::Dataset create(hid_t group, const std::string& name, const std::vector<std::string>& texts) {
  std::vector<const char*> pointers;
  for (const std::string& text : texts) pointers.push_back(text.c_str());
  const hsize_t count = texts.size();
  const hdf5::Datatype type = hdf5::text_type();
  hdf5::Dataset dataset = hdf5::create_dataset(group, name, type, {&count, 1});
  check(H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, pointers.data()), "write " + name);
  return dataset;
}

void write_column(hid_t group, const Column& column, hid_t rows) {
  const std::string what = "write column " + column.name;
  const hdf5::Dataset dataset = std::visit(
      [&](const auto& values) { return create(group, column.name, values); }, column.values);
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
  std::vector<TextColumn> columns;
  for (const Column& column : table.columns) {
    if (!column.printed) continue;
    TextColumn printed{{column.name, column.units == "1" ? "" : column.units}, is_text(column)};
    for (std::size_t row = 0; row < table.rows(); ++row) printed.cells.push_back(cell(column, row));
    columns.push_back(std::move(printed));
  }
  std::string text = table.meaning + "\n";
  for (const std::string& line : aligned(columns))
    if (!line.empty()) text += line + "\n";  // the line of units may be empty
  return text;
}

void write(const hdf5::File& file, const Table& table) {
  const std::string what = "write table " + table.name;
  const hdf5::Group group(
      H5Gcreate2(file, table.name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), what);
  hdf5::write_attribute(group, "title", table.meaning);
  const std::size_t n = table.rows();
  if (n == 0) return;
  std::vector<double> numbers(n);
  std::iota(numbers.begin(), numbers.end(), 0.0);
  const hdf5::Dataset rows = create(group, "row", numbers);
  check(H5DSset_scale(rows, "row"), what);
  for (const Column& column : table.columns) write_column(group, column, rows);
}

}  // namespace trebsweep
