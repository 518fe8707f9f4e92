#include "trebsweep/archive/empty_chunk.hpp"

namespace trebsweep {

using hdf5::check;

hdf5::Properties map_storage(const MapInfo& info, const Index3& edge, int compression) {
  const std::string what = "set up map " + info.dataset;
  hdf5::Properties storage(H5Pcreate(H5P_DATASET_CREATE), what);
  const auto chunk = sizes(edge);
  check(H5Pset_chunk(storage, 3, chunk.data()), what);
  check(H5Pset_fill_value(storage, H5T_NATIVE_DOUBLE, &info.fill), what);
  check(H5Pset_alloc_time(storage, H5D_ALLOC_TIME_INCR), what);
  if (compression > 0) {
    check(H5Pset_shuffle(storage), what);
    check(H5Pset_deflate(storage, static_cast<unsigned>(compression)), what);
  }
  return storage;
}

std::vector<unsigned char> empty_chunk(hid_t storage, const MapInfo& info, const Index3& edge) {
  const std::string what = "make an empty chunk";
  const hdf5::Properties memory_only(H5Pcreate(H5P_FILE_ACCESS), what);
  check(H5Pset_fapl_core(memory_only, 1 << 20, false), what);
  const hdf5::File file(H5Fcreate("chunk", H5F_ACC_TRUNC, H5P_DEFAULT, memory_only), what);
  const auto extent = sizes(edge);
  const hdf5::Dataspace space(H5Screate_simple(3, extent.data(), nullptr), what);
  const hdf5::Dataset chunk(
      H5Dcreate2(file, "chunk", file_type(info.type), space, H5P_DEFAULT, storage, H5P_DEFAULT),
      what);
  const std::array<hsize_t, 3> first{0, 0, 0}, one{1, 1, 1};
  check(H5Sselect_hyperslab(space, H5S_SELECT_SET, first.data(), nullptr, one.data(), nullptr),
        what);
  const hdf5::Dataspace memory(H5Screate_simple(3, one.data(), nullptr), what);
  check(H5Dwrite(chunk, H5T_NATIVE_DOUBLE, memory, space, H5P_DEFAULT, &info.fill), what);
  check(H5Fflush(file, H5F_SCOPE_LOCAL), what);
  hsize_t size = 0;
  check(H5Dget_chunk_storage_size(chunk, first.data(), &size), what);
  std::vector<unsigned char> bytes(size);
  std::uint32_t filters = 0;
  check(H5Dread_chunk(chunk, H5P_DEFAULT, first.data(), &filters, bytes.data()), what);
  return bytes;
}

void write_chunk(hid_t dataset, const Tile& tile, const std::vector<unsigned char>& bytes) {
  const auto first = sizes(tile.first);
  check(H5Dwrite_chunk(dataset, H5P_DEFAULT, 0, first.data(), bytes.size(), bytes.data()),
        "empty a chunk");
}

}  // namespace trebsweep
