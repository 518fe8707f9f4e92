#include "trebsweep/archive/archive_writer.hpp"

#include <array>

#include "trebsweep/archive/partial.hpp"
#include "trebsweep/base/mpi.hpp"

namespace trebsweep {
namespace {

using hdf5::check;

/// HDF5 requires collective writes for compressed datasets. Below it each rank writes its own data,
/// whole chunks, independently: collecting them on aggregator ranks takes longer, and Open MPI 4.1
/// does not always report an aggregator's failures, such as a full disk.
hdf5::Properties collective_transfer() {
  const std::string what = "set up collective writing";
  hdf5::Properties transfer(H5Pcreate(H5P_DATASET_XFER), what);
  check(H5Pset_dxpl_mpio(transfer, H5FD_MPIO_COLLECTIVE), what);
  check(H5Pset_dxpl_mpio_collective_opt(transfer, H5FD_MPIO_INDIVIDUAL_IO), what);
  return transfer;
}

template <class Number>
void write_numbers(hid_t dataset, hid_t memory_type, hid_t memory, hid_t file, hid_t transfer,
                   const std::vector<double>& values) {
  // Converted here because HDF5 makes a collective write independent if it has to convert types.
  const std::vector<Number> numbers(values.begin(), values.end());
  check(H5Dwrite(dataset, memory_type, memory, file, transfer, numbers.data()), "write a map");
}

/// Writes rows of a dataset that has one row per tile; called by one rank.
void write_rows(hid_t dataset, std::uint64_t first, std::size_t count, std::size_t columns,
                hid_t type, const void* rows) {
  const std::string what = "mark tiles done";
  const hdf5::Dataspace file(H5Dget_space(dataset), what);
  // A dataset of rank 1 uses only the first element of each.
  const std::array<hsize_t, 2> start{first, 0}, extent{count, columns};
  check(H5Sselect_hyperslab(file, H5S_SELECT_SET, start.data(), nullptr, extent.data(), nullptr),
        what);
  const hsize_t values = count * columns;
  const hdf5::Dataspace memory(H5Screate_simple(1, &values, nullptr), what);
  check(H5Dwrite(dataset, type, memory, file, H5P_DEFAULT, rows), what);
}

}  // namespace

ArchiveWriter::ArchiveWriter(const std::filesystem::path& path, const std::vector<MapInfo>& maps,
                             MPI_Comm comm)
    : path_(path), comm_(comm), collective_(collective_transfer()) {
  hdf5::silence();
  file_.emplace(hdf5::open_parallel(partial_path(path), comm));
  for (const MapInfo& map : maps)
    maps_.push_back({hdf5::open_dataset(*file_, map.dataset), map.type});
  tile_done_ = hdf5::open_dataset(*file_, "tile_done");
  tile_tally_ = hdf5::open_dataset(*file_, "tile_tally");
}

void ArchiveWriter::write_maps(const std::optional<Tile>& tile,
                               std::span<const std::vector<double>> maps) {
  for (std::size_t m = 0; m < maps_.size(); ++m) {
    const Map& map = maps_[m];
    const hdf5::Dataspace file(H5Dget_space(map.dataset), "write a map");
    // Of the same rank as the file's: otherwise HDF5 maps the selection to chunks value by value.
    const auto extent = sizes(tile ? tile->count : Index3{1, 1, 1});
    const hdf5::Dataspace memory(H5Screate_simple(3, extent.data(), nullptr), "write a map");
    static const std::vector<double> no_values;
    if (tile) {
      const auto first = sizes(tile->first);
      check(
          H5Sselect_hyperslab(file, H5S_SELECT_SET, first.data(), nullptr, extent.data(), nullptr),
          "write a map");
    } else {
      check(H5Sselect_none(file), "write a map");
      check(H5Sselect_none(memory), "write a map");
    }
    const std::vector<double>& values = tile ? maps[m] : no_values;
    switch (map.type) {
      case MapType::float64:
        write_numbers<double>(map.dataset, H5T_NATIVE_DOUBLE, memory, file, collective_, values);
        break;
      case MapType::float32:
        write_numbers<float>(map.dataset, H5T_NATIVE_FLOAT, memory, file, collective_, values);
        break;
      case MapType::uint8:
        write_numbers<unsigned char>(map.dataset, H5T_NATIVE_UCHAR, memory, file, collective_,
                                     values);
        break;
    }
  }
}

void ArchiveWriter::write(const std::optional<Tile>& tile,
                          std::span<const std::vector<double>> maps) {
  write_partial(partial_path(path_), [&] { write_maps(tile, maps); });
}

void ArchiveWriter::checkpoint(std::uint64_t first, std::span<const TallyRow> tallies) {
  write_partial(partial_path(path_), [&] {
    const bool root = mpi::rank(comm_) == 0;
    if (root)
      write_rows(*tile_tally_, first, tallies.size(), tally_columns.size(), H5T_NATIVE_DOUBLE,
                 tallies.data());
    // Data and tallies must be in the file before the marks.
    flush();
    const std::vector<unsigned char> done(tallies.size(), 1);
    if (root) write_rows(*tile_done_, first, done.size(), 1, H5T_NATIVE_UCHAR, done.data());
    flush();
  });
}

void ArchiveWriter::write(const Attributes& attributes) {
  write_partial(partial_path(path_), [&] { write_attributes(*file_, attributes); });
}

void ArchiveWriter::flush() {
  check(H5Fflush(*file_, H5F_SCOPE_GLOBAL), "flush the file");
  MPI_Barrier(comm_);  // the flush ends with an fsync on every rank, which is not a barrier
}

void ArchiveWriter::close() {
  write_partial(partial_path(path_), [&] {
    flush();
    tile_done_.reset();
    tile_tally_.reset();
    maps_.clear();
    file_->close("close the file");
  });
}

}  // namespace trebsweep
