#include "trebsweep/archive/run_id.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <random>
#include <stdexcept>
#include <string>

#include "trebsweep/archive/hdf5.hpp"

namespace trebsweep {
namespace {

hdf5::Dataset open_or_create(hid_t file) {
  const std::string what = "write run_id";
  if (hdf5::check(H5Lexists(file, "run_id", H5P_DEFAULT), what) > 0)
    return {H5Dopen2(file, "run_id", H5P_DEFAULT), what};
  const hdf5::Dataspace space(H5Screate(H5S_SCALAR), what);
  const hdf5::Properties creation(H5Pcreate(H5P_DATASET_CREATE), what);
  hdf5::check(H5Pset_alloc_time(creation, H5D_ALLOC_TIME_EARLY), what);
  hdf5::Dataset dataset(
      H5Dcreate2(file, "run_id", H5T_STD_U64LE, space, H5P_DEFAULT, creation, H5P_DEFAULT), what);
  hdf5::write_attribute(dataset, "long_name",
                        std::string("random number of the run that wrote the file last"));
  return dataset;
}

std::uint64_t random_number() {
  std::random_device device;
  return std::uint64_t{device()} << 32 | device();
}

/// Whether the path names the file with this id. The file is opened each time, so that a network
/// file system asks the server.
bool has_run_id(const RunId& run_id, const std::filesystem::path& path) {
  const int file = open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (file < 0) return false;
  struct stat found {};
  unsigned char bytes[8];  // little-endian, as in the file
  const bool read = fstat(file, &found) == 0 &&
                    pread(file, bytes, sizeof bytes, static_cast<off_t>(run_id.offset)) ==
                        static_cast<ssize_t>(sizeof bytes);
  close(file);
  if (!read) return false;
  std::uint64_t id = 0;
  for (int i = 7; i >= 0; --i) id = id << 8 | bytes[i];
  return id == run_id.id && found.st_dev == run_id.device && found.st_ino == run_id.inode;
}

}  // namespace

RunId write_run_id(hid_t file, const std::filesystem::path& path) {
  const std::string what = "write run_id";
  const hdf5::Dataset dataset = open_or_create(file);
  RunId run_id{};
  run_id.id = random_number();
  const unsigned long long id = run_id.id;
  hdf5::check(H5Dwrite(dataset, H5T_NATIVE_ULLONG, H5S_ALL, H5S_ALL, H5P_DEFAULT, &id), what);
  run_id.offset = H5Dget_offset(dataset);
  if (run_id.offset == HADDR_UNDEF) hdf5::fail(what);
  struct stat found {};
  if (stat(path.c_str(), &found) != 0) throw std::runtime_error("cannot " + what);
  run_id.device = found.st_dev;
  run_id.inode = found.st_ino;
  return run_id;
}

void check_run_id(const RunId& run_id, const std::filesystem::path& path) {
  if (!has_run_id(run_id, path))
    throw std::runtime_error(fmt::format(
        "another run has taken over {}, or it was moved or cannot be read; this run ends",
        path.string()));
}

}  // namespace trebsweep
