#include "trebsweep/archive/archive_format.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <stdexcept>

#include "trebsweep/archive/hdf5.hpp"

namespace trebsweep {

std::string dataset_name(std::string_view name) {
  std::string dataset(name);
  std::replace(dataset.begin(), dataset.end(), '-', '_');
  return dataset;
}

std::string history_line(const std::string& command, std::uint64_t ranks) {
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ} {} ({} {})", fmt::gmtime(std::time(nullptr)), command,
                     ranks, ranks == 1 ? "rank" : "ranks");
}

void write_attributes(hid_t file, const Attributes& attributes) {
  for (const auto& [name, value] : attributes)
    std::visit([&, &key = name](const auto& v) { hdf5::write_attribute(file, key, v); }, value);
}

std::vector<std::string> checksum_columns(const std::vector<MapInfo>& maps, bool is_study) {
  std::vector<std::string> columns;
  for (const MapInfo& map : maps) columns.push_back(map.dataset);
  if (is_study) columns.push_back("best");
  columns.push_back("tile_tally");
  return columns;
}

hid_t file_type(MapType type) {
  switch (type) {
    case MapType::float64:
      return H5T_IEEE_F64LE;
    case MapType::float32:
      return H5T_IEEE_F32LE;
    case MapType::uint8:
      return H5T_STD_U8LE;
  }
  throw std::logic_error("unknown map type");
}

}  // namespace trebsweep
