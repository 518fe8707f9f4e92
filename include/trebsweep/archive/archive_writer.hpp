#pragma once

#include <mpi.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "trebsweep/archive/archive_format.hpp"
#include "trebsweep/archive/hdf5.hpp"
#include "trebsweep/archive/summary.hpp"

namespace trebsweep {

/// The partial file of one job, written by all ranks of a communicator together. Every member is
/// collective: all ranks call it in the same order. Each throws std::runtime_error where HDF5
/// fails.
class ArchiveWriter {
 public:
  /// Opens what create_partial() made of the same path and maps.
  ArchiveWriter(const std::filesystem::path& path, const std::vector<MapInfo>& maps, MPI_Comm comm);

  /// Writes one tile of each rank, map after map (values along r2 fastest); a rank without one
  /// gives no tile.
  void write(const std::optional<Tile>& tile, std::span<const std::vector<double>> maps);

  /// Marks tiles from the first on done, as many as rank 0 gives tallies of, after what was written
  /// of them is on disk.
  void mark_done(std::uint64_t first, std::span<const TallyRow> tallies);

  /// Changes attributes that are there.
  void write(const Attributes& attributes);

  /// Closes the file, so that a failure to write what was buffered is seen.
  void close();

 private:
  struct Map {
    hdf5::Dataset dataset;
    MapType type;
  };

  void write_maps(const std::optional<Tile>& tile, std::span<const std::vector<double>> maps);
  void flush();

  std::filesystem::path path_;
  MPI_Comm comm_;
  hdf5::Properties collective_;
  std::optional<hdf5::File> file_;
  std::vector<Map> maps_;
  std::optional<hdf5::Dataset> tile_done_, tile_tally_;
};

}  // namespace trebsweep
