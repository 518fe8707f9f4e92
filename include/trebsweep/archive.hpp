#pragma once

#include <mpi.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "trebsweep/hdf5.hpp"
#include "trebsweep/job.hpp"
#include "trebsweep/lattice.hpp"

namespace trebsweep {

/// Number types that a map can have in the file.
enum class MapType { float64, float32, uint8 };

/// How a map is stored and described.
struct MapInfo {
  std::string dataset;
  std::string units;  ///< UDUNITS; empty for none
  std::string long_name;
  std::string ancillary;  ///< CF ancillary_variables; empty for none
  MapType type;
  double fill;                             ///< the value of cells outside the lattice
  std::vector<std::string> flag_meanings;  ///< CF flags, of values 0, 1, ...; empty for numbers
};

/// The HDF5 file of one job, written by all ranks of a communicator together.
///
/// It grows under partial_path() and takes its own name only in finish(). Every member is
/// collective: all ranks call it in the same order. Each throws std::runtime_error where HDF5
/// fails.
class Archive {
 public:
  /// The name of an archive that is not complete.
  static std::filesystem::path partial_path(const std::filesystem::path& path);

  /// Creates the partial file: axes, empty maps, tile_done, and nothing done. A file under that
  /// name is replaced.
  Archive(const std::filesystem::path& path, const Lattice& lattice, const Tiling& tiling,
          const std::vector<MapInfo>& maps, int compression, MPI_Comm comm);

  /// Writes one tile of each rank, map after map (values along r2 fastest); a rank without one
  /// gives no tile.
  void write(const std::optional<Tile>& tile, std::span<const std::vector<double>> maps);

  /// Marks tiles [first, first + count) done, after what was written of them is on disk.
  void mark_done(std::uint64_t first, std::uint64_t count);

  template <class Value>
  void attribute(const std::string& name, const Value& value) {
    hdf5::write_attribute(*file_, name, value);
  }

  /// Closes the file and gives it its final name.
  void finish();

 private:
  struct Map {
    hdf5::Dataset dataset;
    MapType type;
  };

  void flush();

  std::filesystem::path path_;
  MPI_Comm comm_;
  hdf5::Properties collective_;
  std::optional<hdf5::File> file_;
  std::vector<Map> maps_;
  std::optional<hdf5::Dataset> tile_done_;
};

/// The job text stored in an archive, or nothing if the file is no archive. Not collective.
std::optional<std::string> archived_job(const std::filesystem::path& path);

}  // namespace trebsweep
