#include "trebsweep/archive/partial.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <stdexcept>

#include "trebsweep/archive/empty_chunk.hpp"
#include "trebsweep/archive/free_space.hpp"
#include "trebsweep/archive/hdf5.hpp"
#include "trebsweep/archive/regular_file.hpp"
#include "trebsweep/base/mpi.hpp"

namespace trebsweep {
namespace {

namespace fs = std::filesystem;
using hdf5::check;

/// A map of numbers whose chunks are to be filled, with the bytes of an empty one.
struct Unfilled {
  hdf5::Dataset map;
  std::vector<unsigned char> bytes;
};

std::vector<Unfilled> unfilled_maps(hid_t file, const Skeleton& skeleton) {
  std::vector<Unfilled> unfilled;
  const Index3& edge = skeleton.tiling.edge();
  for (const MapInfo& info : skeleton.maps)
    if (info.fill != 0)  // what was allocated reads 0
      unfilled.push_back({hdf5::open_dataset(file, info.dataset),
                          empty_chunk(map_storage(info, edge, 0), info, edge)});
  return unfilled;
}

/// Fills the maps of numbers that are not compressed, each rank its share of the tiles; collective.
/// Returns false where a rank was stopped.
bool fill(const fs::path& path, const Skeleton& skeleton, const Watch& watch, MPI_Comm comm) {
  const auto rank = static_cast<std::uint64_t>(mpi::rank(comm));
  const auto ranks = static_cast<std::uint64_t>(mpi::size(comm));
  hdf5::File file = hdf5::open_parallel(path, comm);
  auto unfilled = unfilled_maps(file, skeleton);
  std::size_t bytes = 1;
  for (const Unfilled& map : unfilled) bytes += map.bytes.size();
  const std::uint64_t batch = std::max<std::uint64_t>(1, (std::uint64_t{16} << 20) / bytes);
  const std::uint64_t tiles = unfilled.empty() ? 0 : skeleton.tiling.size();
  for (std::uint64_t first = 0; first < tiles; first += batch * ranks) {
    const bool stop = watch(static_cast<double>(first) / static_cast<double>(tiles));
    if (mpi::max(stop ? 1 : 0, comm) > 0) return false;
    mpi::on_all(comm, [&] {
      const std::uint64_t begin = first + rank * batch, end = std::min(begin + batch, tiles);
      for (std::uint64_t t = begin; t < end; ++t)
        for (const Unfilled& map : unfilled)
          write_chunk(map.map, skeleton.tiling.tile(t), map.bytes);
    });
  }
  unfilled.clear();
  mpi::on_all(comm, [&] { file.close("close " + path.string()); });
  return true;
}

/// Empties the compressed chunks at the upper ends of a map that are not done. HDF5 reads those
/// before it writes them, as tiles do not fill them, and a machine that went down may have left
/// anything there.
void renew_edges(hid_t file, const MapInfo& info, const Tiling& tiling, std::uint64_t done) {
  const hdf5::Dataset dataset = hdf5::open_dataset(file, info.dataset);
  const hdf5::Properties storage(H5Dget_create_plist(dataset), "read a map's form");
  if (H5Pget_nfilters(storage) == 0) return;
  const auto bytes = empty_chunk(storage, info, tiling.edge());
  for (std::uint64_t t = done; t < tiling.size(); ++t) {
    const Tile tile = tiling.tile(t);
    if (tile.count != tiling.edge()) write_chunk(dataset, tile, bytes);
  }
}

}  // namespace

std::string history_line(const std::string& command, std::uint64_t ranks) {
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ} {} ({} ranks)", fmt::gmtime(std::time(nullptr)),
                     command, ranks);
}

fs::path partial_path(const fs::path& path) { return path.string() + ".partial"; }

fs::path new_path(const fs::path& path) { return path.string() + ".partial.new"; }

std::optional<RunId> create_partial(const fs::path& path, const Skeleton& skeleton,
                                    const Watch& watch, MPI_Comm comm) {
  hdf5::silence();
  const fs::path unnamed = new_path(path);
  const bool plain = skeleton.compression == 0;
  // Allocating is quick next to filling.
  const double skeleton_share = plain ? 0.2 : 1;
  std::optional<RunId> mark;
  const auto remove = [&] {
    std::error_code ignored;
    if (mpi::rank(comm) == 0) fs::remove(unnamed, ignored);
  };
  try {
    mpi::on_root(comm, [&] {
      fs::remove(unnamed);
      require_space(unnamed, size_of(skeleton));
      mark = create_skeleton(unnamed, skeleton,
                             [&](double share) { return watch(skeleton_share * share); });
    });
    mark = mpi::from_root(mark, comm);
    if (mark) require_visible(unnamed, comm);
    const auto fill_watch = [&](double share) {
      return watch(skeleton_share + (1 - skeleton_share) * share);
    };
    if (mark && plain && !fill(unnamed, skeleton, fill_watch, comm)) mark.reset();
    mpi::on_root(comm, [&] {
      if (!mark) return;
      check_run_id(*mark, unnamed);
      fs::rename(unnamed, partial_path(path));
    });
  } catch (const mpi::RootError&) {  // thrown on all ranks; others end the program
    remove();
    throw;
  }
  if (!mark) remove();
  return mark;
}

RunId continue_partial(const fs::path& path, const Tiling& tiling, const std::vector<MapInfo>& maps,
                       std::uint64_t done, const std::string& history_line) {
  hdf5::silence();
  const fs::path partial = partial_path(path);
  RunId mark{};
  write_in(partial, [&] {
    hdf5::File file(H5Fopen(partial.c_str(), H5F_ACC_RDWR, H5P_DEFAULT),
                    "open " + partial.string());
    mark = write_run_id(file, partial);
    for (const MapInfo& map : maps) renew_edges(file, map, tiling, done);
    std::string history;
    try {
      history = hdf5::read_text_attribute(file, "history") + "\n";
    } catch (const std::runtime_error&) {
      // A run was killed while it was written: not worth the rest.
    }
    hdf5::write_attribute(file, "history", history + history_line);
    file.close("close the file");
  });
  return mark;
}

void require_visible(const fs::path& path, MPI_Comm comm) {
  mpi::on_all(comm, [&] {
    if (!fs::exists(path))
      throw std::runtime_error(
          fmt::format("rank {} does not see {}: all ranks must work in one folder of a file system "
                      "that they share",
                      mpi::rank(comm), path.string()));
  });
}

void finish(const fs::path& path, const RunId& mark, const std::string& replaces) {
  check_run_id(mark, partial_path(path));
  rename_new(partial_path(path), path, replaces);
}

void rename_new(const fs::path& from, const fs::path& to, const std::string& replaces) {
  if (fs::exists(fs::symlink_status(to)) && file_identity(to) != replaces)
    throw std::runtime_error(fmt::format(
        "cannot rename {} to {}: a file of that name has appeared in the meantime; move "
        "it away, and the same command will finish",
        from.string(), to.string()));
  fs::rename(from, to);
}

void write_in(const fs::path& partial, const std::function<void()>& f) {
  try {
    f();
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(fmt::format(
        "{} in {}{}; what was marked done is kept there, and the same command will continue it",
        error.what(), partial.string(), obstacle(partial)));
  }
}

}  // namespace trebsweep
