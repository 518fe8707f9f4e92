#pragma once

#include <hdf5.h>
#include <mpi.h>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace trebsweep::hdf5 {

/// Keeps HDF5 from printing its error stack: failures are reported once, by fail().
void silence();

/// Throws std::runtime_error saying what failed, with HDF5's own reason.
[[noreturn]] void fail(const std::string& what);

/// The result of an HDF5 call; throws where it tells of failure (a negative value). `what`
/// completes "cannot ...".
template <class Result>
Result check(Result result, const std::string& what) {
  if (result < 0) fail(what);
  return result;
}

/// An HDF5 identifier, closed at the end of its scope.
template <herr_t (*Close)(hid_t)>
class Handle {
 public:
  /// Throws std::runtime_error where `id` tells of failure.
  Handle(hid_t id, const std::string& what) : id_(check(id, what)) {}
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, H5I_INVALID_HID)) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(id_, other.id_);
    return *this;
  }
  ~Handle() {
    if (id_ >= 0) Close(id_);
  }

  operator hid_t() const { return id_; }

  /// Closes now, so that a failure to write what was buffered is seen.
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

/// Opens a file to be written by all ranks of a communicator; collective.
File open_parallel(const std::filesystem::path& path, MPI_Comm comm);

Dataset open_dataset(hid_t file, const std::string& name);

/// Texts of any length in UTF-8: what h5py and netCDF read as str.
Datatype text_type();

/// Writes an attribute; a number that is there already changes in place, so that no more than a few
/// bytes of the file do.
void write_attribute(hid_t object, const std::string& name, const std::string& value);
void write_attribute(hid_t object, const std::string& name, double value);
void write_attribute(hid_t object, const std::string& name, unsigned long long value);

// What follows reads files of any origin: where something is not of the expected form and size, it
// throws std::runtime_error.

std::string read_text_attribute(hid_t object, const std::string& name);
double read_number_attribute(hid_t object, const std::string& name);

/// The names of a group's members, in alphabetical order.
std::vector<std::string> link_names(hid_t group);

/// The extents of a dataset.
std::vector<hsize_t> extents(hid_t dataset);

/// All values of a dataset whose values lie in the file one after another, last axis fastest.
std::vector<double> read_numbers(hid_t file, const std::string& name);

}  // namespace trebsweep::hdf5
