#include "trebsweep/archive/partial.hpp"

#include <fmt/format.h>

#include <stdexcept>

#include "trebsweep/archive/free_space.hpp"
#include "trebsweep/archive/hdf5.hpp"
#include "trebsweep/archive/map_chunks.hpp"
#include "trebsweep/archive/regular_file.hpp"
#include "trebsweep/base/mpi.hpp"

namespace trebsweep {

namespace fs = std::filesystem;

std::optional<RunId> create_partial(const fs::path& path, const Skeleton& skeleton,
                                    const ProgressCallback& progress, MPI_Comm comm) {
  hdf5::silence();
  const fs::path file = new_path(path);
  const bool must_fill = skeleton.compression == 0;
  // Allocating chunks is fast compared with filling them.
  const double skeleton_fraction = must_fill ? 0.2 : 1;
  std::optional<RunId> run_id;
  const auto remove = [&] {
    std::error_code ignored;
    if (mpi::rank(comm) == 0) fs::remove(file, ignored);
  };
  try {
    mpi::on_root(comm, [&] {
      fs::remove(file);
      require_space(skeleton.study.job(), file, minimum_size(skeleton));
      run_id = create_skeleton(
          file, skeleton, [&](double fraction) { return progress(skeleton_fraction * fraction); });
    });
    run_id = mpi::from_root(run_id, comm);
    if (run_id) require_visible(file, comm);
    const auto fill_progress = [&](double fraction) {
      return progress(skeleton_fraction + (1 - skeleton_fraction) * fraction);
    };
    if (run_id && must_fill &&
        !fill_uncompressed(file, skeleton.maps, MapShape(skeleton.study), skeleton.tiling,
                           fill_progress, comm))
      run_id.reset();
    mpi::on_root(comm, [&] {
      if (!run_id) return;
      check_run_id(*run_id, file);
      fs::rename(file, partial_path(path));
    });
  } catch (const mpi::RootError&) {  // thrown on all ranks, after a file may have been created
    remove();
    throw;
  }
  if (!run_id) remove();
  return run_id;
}

RunId continue_partial(const fs::path& path, const Study& study, const Tiling& tiling,
                       const std::vector<MapInfo>& maps, const std::vector<TileRange>& to_compute,
                       const std::string& history_line) {
  hdf5::silence();
  const fs::path partial = partial_path(path);
  const MapShape shape(study);
  require_allocated(partial, maps, shape, tiling, to_compute);
  RunId run_id{};
  write_partial(partial, [&] {
    hdf5::File file(H5Fopen(partial.c_str(), H5F_ACC_RDWR, H5P_DEFAULT),
                    "open " + partial.string());
    // A run that was killed within a flush may have written the index of compressed chunks, but not
    // the size of the file that holds them.
    hdf5::check(H5Fincrement_filesize(file, 0), "set the file's size");
    run_id = write_run_id(file, partial);
    for (const MapInfo& map : maps) reset_edge_chunks(file, map, shape, tiling, to_compute);
    std::string history;
    try {
      history = hdf5::read_text_attribute(file, "history") + "\n";
    } catch (const std::runtime_error&) {
      // A run was killed while writing it: the maps are worth more than the history.
    }
    hdf5::write_attribute(file, "history", history + history_line);
    file.close("close the file");
  });
  return run_id;
}

void require_visible(const fs::path& path, MPI_Comm comm) {
  mpi::on_all(comm, [&] {
    if (!fs::exists(path))
      throw std::runtime_error(fmt::format(
          "rank {} cannot see {}: all ranks must run in the same directory of a shared file system",
          mpi::rank(comm), path.string()));
  });
}

void finish_partial(const fs::path& path, const RunId& run_id, const std::string& replaces) {
  check_run_id(run_id, partial_path(path));
  rename_to_final(partial_path(path), path, replaces);
}

void rename_to_final(const fs::path& from, const fs::path& to, const std::string& replaces) {
  if (fs::exists(fs::symlink_status(to)) && file_identity(to) != replaces)
    throw std::runtime_error(
        fmt::format("cannot rename {} to {}: a file with that name has appeared in the meantime; "
                    "move it away, and the same command will finish the archive",
                    from.string(), to.string()));
  fs::rename(from, to);
}

void write_partial(const fs::path& partial, const std::function<void()>& write) {
  try {
    write();
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(fmt::format(
        "{} in {}{}; the tiles marked done are kept there, and the same command will continue it",
        error.what(), partial.string(), reached_limit(partial)));
  }
}

}  // namespace trebsweep
