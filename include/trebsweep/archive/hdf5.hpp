#pragma once

#include <hdf5.h>
#include <mpi.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace trebsweep::hdf5 {

/// Keeps HDF5 from printing its error stack: fail() reports an error once.
void silence();

/// Throws std::runtime_error with the message "cannot <what>: <HDF5's reason>".
[[noreturn]] void fail(const std::string& what);

/// Returns the result of an HDF5 call, or calls fail(what) if it is negative, which means failure.
template <class Result>
Result check(Result result, const std::string& what) {
  if (result < 0) fail(what);
  return result;
}

/// Owns an HDF5 identifier and closes it in the destructor.
template <herr_t (*Close)(hid_t)>
class Handle {
 public:
  /// Calls fail(what) if `id` is invalid.
  Handle(hid_t id, const std::string& what) : id_(check(id, what)) {}
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, H5I_INVALID_HID)) {}
  ~Handle() {
    if (id_ >= 0) Close(id_);
  }

  operator hid_t() const { return id_; }

  /// Closes now; unlike the destructor, reports a failure to do so.
  void close(const std::string& what) { check(Close(std::exchange(id_, H5I_INVALID_HID)), what); }

 private:
  hid_t id_;
};

using File = Handle<&H5Fclose>;
using Group = Handle<&H5Gclose>;
using Dataset = Handle<&H5Dclose>;
using Dataspace = Handle<&H5Sclose>;
using Datatype = Handle<&H5Tclose>;
using Attribute = Handle<&H5Aclose>;
using Properties = Handle<&H5Pclose>;

/// The HDF5 type of a number in memory.
template <class Number>
hid_t native_type() {
  if constexpr (std::is_same_v<Number, double>) return H5T_NATIVE_DOUBLE;
  if constexpr (std::is_same_v<Number, std::uint64_t>) return H5T_NATIVE_UINT64;
  if constexpr (std::is_same_v<Number, unsigned char>) return H5T_NATIVE_UCHAR;
}

/// Opens a file for writing by all ranks of a communicator; collective.
File open_parallel(const std::filesystem::path& path, MPI_Comm comm);

Dataset open_dataset(hid_t file, const std::string& name);

/// Creates a dataset of the given type and extents.
Dataset create_dataset(hid_t file, const std::string& name, hid_t type,
                       std::span<const hsize_t> extents, hid_t properties = H5P_DEFAULT);

/// Properties of a dataset of one chunk with a checksum; the default ones for a single value, which
/// HDF5 stores without.
Properties with_checksum(std::span<const hsize_t> extents);

/// The same with its values, last axis fastest, and with a checksum, so that reading it fails if it
/// is damaged.
template <class Number>
Dataset create_dataset(hid_t file, const std::string& name, std::span<const hsize_t> extents,
                       const std::vector<Number>& values) {
  Dataset dataset =
      create_dataset(file, name, native_type<Number>(), extents, with_checksum(extents));
  check(H5Dwrite(dataset, native_type<Number>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()),
        "write " + name);
  return dataset;
}

/// A block of a dataset, and the same block in memory.
struct Selection {
  Dataspace file, memory;
};
Selection select(hid_t dataset, std::span<const hsize_t> first, std::span<const hsize_t> count);

/// Variable-length UTF-8 text, which h5py and netCDF read as str.
Datatype text_type();

/// Creates an attribute: a text, a double, or a count.
void write_attribute(hid_t object, const std::string& name, const std::string& value);
void write_attribute(hid_t object, const std::string& name, double value);
void write_attribute(hid_t object, const std::string& name, std::uint64_t value);

/// The same with some numbers, of the given type in the file.
void write_attribute(hid_t object, const std::string& name, hid_t type,
                     std::span<const double> values);

// The functions below read files of any origin. They throw std::runtime_error if an object does not
// have the expected type and size.

std::string read_text_attribute(hid_t object, const std::string& name);
double read_number_attribute(hid_t object, const std::string& name);

/// The names of a group's members, in alphabetical order.
std::vector<std::string> link_names(hid_t group);

/// The number of values of a contiguous dataset.
std::size_t count_values(hid_t file, hid_t dataset);

/// The extent of each axis of a dataset.
std::vector<hsize_t> extents(hid_t dataset);

/// All values of a contiguous dataset, last axis fastest.
template <class Number = double>
std::vector<Number> read_numbers(hid_t file, const std::string& name) {
  const Dataset dataset = open_dataset(file, name);
  std::vector<Number> values(count_values(file, dataset));
  check(H5Dread(dataset, native_type<Number>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()),
        "read " + name);
  return values;
}

}  // namespace trebsweep::hdf5
