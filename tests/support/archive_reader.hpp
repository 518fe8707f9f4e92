#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "trebsweep/archive/hdf5.hpp"
#include "trebsweep/base/mpi.hpp"

namespace trebsweep {

/// All values of a dataset of an archive, last axis fastest; for one rank.
inline std::vector<double> read_map(const std::filesystem::path& path, const std::string& name) {
  const hdf5::File file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT),
                        "open " + path.string());
  const hdf5::Dataset map = hdf5::open_dataset(file, name);
  const hdf5::Dataspace space(H5Dget_space(map), "read " + name);
  std::vector<double> values(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
  hdf5::check(H5Dread(map, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()),
              "read " + name);
  return values;
}

/// A path for an archive in the directory of the test programs, the same on all ranks. The
/// destructor waits for all ranks and removes the archive and the folder of its sweep.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& name)
      : path_(TEST_DIR "/" + name + "_" + std::to_string(mpi::size(MPI_COMM_WORLD)) + ".h5") {}
  ~TemporaryFile() {
    MPI_Barrier(MPI_COMM_WORLD);
    if (mpi::rank(MPI_COMM_WORLD) != 0) return;
    std::filesystem::remove(path_);
    std::filesystem::remove_all(path_.string() + ".partial");
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace trebsweep
