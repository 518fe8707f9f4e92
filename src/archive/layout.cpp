#include "trebsweep/archive/layout.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <limits>

namespace trebsweep {

double fill_value(Field field) {
  return is_flag(field) ? 0 : std::numeric_limits<double>::quiet_NaN();
}

std::string dataset_name(std::string_view name) {
  std::string dataset(name);
  std::replace(dataset.begin(), dataset.end(), '-', '_');
  return dataset;
}

std::string dataset_name(Field field) { return dataset_name(info(field).name); }

hid_t file_type(Field field, Storage storage) {
  if (is_flag(field)) return H5T_STD_U8LE;
  return storage == Storage::float32 ? H5T_IEEE_F32LE : H5T_IEEE_F64LE;
}

std::uint64_t bytes_in(const Block& block, const Output& output) {
  std::uint64_t bytes = 0;
  for (const Field field : stored_fields(output))
    bytes += block.cells() * H5Tget_size(file_type(field, output.storage));
  return bytes;
}

std::vector<hsize_t> map_extents(const Study& study) {
  std::vector<hsize_t> extents;
  for (const OuterAxis& axis : study.job().outer_axes) extents.push_back(axis.values.size());
  const Index3 box = study.extent();
  extents.insert(extents.end(), box.begin(), box.end());
  return extents;
}

MapBlock map_block(const Tile& tile, std::span<const hsize_t> map_extents) {
  const std::size_t outer = map_extents.size() - 3;
  MapBlock block{std::vector<hsize_t>(outer), std::vector<hsize_t>(outer, 1)};
  std::uint64_t scene = tile.scene;
  for (std::size_t d = outer; d-- > 0; scene /= map_extents[d])
    block.first[d] = scene % map_extents[d];
  const auto& [first, count] = tile.block;
  block.first.insert(block.first.end(), first.begin(), first.end());
  block.count.insert(block.count.end(), count.begin(), count.end());
  return block;
}

std::string history_line(const std::string& command, int ranks) {
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ} {} ({} {})", fmt::gmtime(std::time(nullptr)), command,
                     ranks, ranks == 1 ? "rank" : "ranks");
}

}  // namespace trebsweep
