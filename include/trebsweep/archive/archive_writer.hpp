#pragma once

#include <mpi.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "trebsweep/archive/archive_format.hpp"
#include "trebsweep/archive/hdf5.hpp"
#include "trebsweep/archive/map_shape.hpp"
#include "trebsweep/archive/scene_optimum.hpp"
#include "trebsweep/archive/summary.hpp"

namespace trebsweep {

/// Writes the partial file of a job, with all ranks of a communicator; partial.hpp describes the
/// order of the writes. Every member function is collective and throws std::runtime_error if HDF5
/// fails.
class ArchiveWriter {
 public:
  /// Opens the file that create_partial() created for the same path, maps and study.
  ArchiveWriter(const std::filesystem::path& path, const std::vector<MapInfo>& maps,
                const Study& study, MPI_Comm comm);

  /// Writes one tile of each rank; a rank without one passes no tile. `maps` holds the values of
  /// each map in the tile, r2 fastest. Returns the checksum of each map's bytes as a reader gets
  /// them, without compression.
  std::vector<std::uint64_t> write(const std::optional<Tile>& tile,
                                   std::span<const std::vector<double>> maps);

  /// Writes the optima of consecutive scenes of a study, the first of which has the number
  /// `first_scene`. Only rank 0's are used.
  void write_optima(std::uint64_t first_scene, std::span<const SceneOptimum> optima);

  /// Marks the tiles of a round, numbered from `first`, as done once their data is on disk. Only
  /// rank 0's tallies, one per tile, and checksums are used: for each tile those of
  /// checksum_columns() except that of its tally.
  void checkpoint(std::uint64_t first, std::span<const TallyRow> tallies,
                  std::span<const std::uint64_t> checksums);

  /// Overwrites existing attributes.
  void write(const Attributes& attributes);

  /// Flushes and closes the file; unlike the destructor, reports a failure to do so.
  void close();

 private:
  struct Map {
    hdf5::Dataset dataset;
    MapType type;
    bool compressed;
    Index3 edge;  ///< of a chunk
  };

  static Map open_map(hid_t file, const MapInfo& info);
  std::vector<std::uint64_t> write_maps(const std::optional<Tile>& tile,
                                        std::span<const std::vector<double>> maps);
  void write_collectively(const Map& map, const std::optional<Tile>& tile,
                          std::span<const std::byte> bytes);
  void write_results(std::uint64_t first, std::span<const TallyRow> tallies,
                     std::span<const std::uint64_t> checksums);
  void flush();

  std::filesystem::path path_;
  MapShape shape_;
  MPI_Comm comm_;
  hdf5::Properties collective_;
  std::optional<hdf5::File> file_;
  std::vector<Map> maps_;
  std::optional<hdf5::Dataset> tile_done_, tile_tally_, tile_checksum_;
};

}  // namespace trebsweep
