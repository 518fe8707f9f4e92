#include "trebsweep/archive/archive_header.hpp"

#include <algorithm>
#include <stdexcept>
#include <system_error>

#include "trebsweep/archive/hdf5.hpp"
#include "trebsweep/archive/untrusted_file.hpp"

namespace trebsweep {
namespace {

ArchiveHeader read_header(const std::filesystem::path& path) {
  const hdf5::File file = untrusted::open(path);
  if (!untrusted::read_text(file, "source").starts_with("trebsweep "))
    untrusted::fail("created by another program");
  ArchiveHeader header{.job = untrusted::read_text(file, "job"),
                       .is_sweep = H5Lexists(file, "tile_done", H5P_DEFAULT) > 0};
  if (header.is_sweep) {
    const auto done = hdf5::read_numbers(file, "tile_done");
    header.tiles = done.size();
    header.tiles_done = static_cast<std::uint64_t>(std::ranges::count(done, 1.0));
  } else if (H5Lexists(file, "accuracy", H5P_DEFAULT) <= 0) {
    untrusted::fail("neither a sweep nor an assessment");
  }
  return header;
}

}  // namespace

std::optional<ArchiveHeader> read_archive_header(const std::filesystem::path& path) {
  try {
    return read_header(path);
  } catch (const std::runtime_error&) {
    return std::nullopt;
  }
}

}  // namespace trebsweep
