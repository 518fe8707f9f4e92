#pragma once

#include <mpi.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "trebsweep/hdf5.hpp"
#include "trebsweep/job.hpp"
#include "trebsweep/lattice.hpp"
#include "trebsweep/summary.hpp"

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

/// Root attributes, by name.
using Attributes =
    std::vector<std::pair<std::string, std::variant<std::string, double, unsigned long long>>>;

/// The version of the form of archives: format_version.
inline constexpr unsigned long long archive_format = 2;

/// What an archive's history says of a run that begins now.
std::string history_line(const std::string& command, std::uint64_t ranks);

/// The name of an archive that is not complete.
std::filesystem::path partial_path(const std::filesystem::path& path);

/// Creates the partial file with all that it will ever hold, but for values: axes, empty maps,
/// attributes, tile_done and tile_tally; nothing in it is moved later, so that a killed run leaves
/// it sound. It gets its name when it is whole; a file under that name is replaced. For one rank
/// alone, since HDF5 would allocate every chunk of a dataset that is created in parallel. Returns
/// false, leaving nothing, where `stop` asked for it. Throws std::runtime_error, leaving nothing.
bool create_partial(const std::filesystem::path& path, const Lattice& lattice, const Tiling& tiling,
                    const std::vector<MapInfo>& maps, int compression, const Attributes& attributes,
                    const std::function<bool()>& stop);

/// Makes a partial file ready for another run, of which its history gets a line: the tiles from
/// number `done` on are to be computed. For one rank alone. Throws std::runtime_error.
void continue_partial(const std::filesystem::path& path, const Tiling& tiling,
                      const std::vector<MapInfo>& maps, std::uint64_t done,
                      const std::string& history_line);

/// Gives the complete partial file its own name. For one rank alone.
void finish(const std::filesystem::path& path);

/// The partial file of one job, written by all ranks of a communicator together. Every member is
/// collective: all ranks call it in the same order. Each throws std::runtime_error where HDF5
/// fails.
class Archive {
 public:
  /// Opens what create_partial() made of the same path and maps.
  Archive(const std::filesystem::path& path, const std::vector<MapInfo>& maps, MPI_Comm comm);

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
