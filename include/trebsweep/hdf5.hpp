#pragma once

#include <hdf5.h>

#include <string>
#include <utility>

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

/// Texts of any length in UTF-8: what h5py and netCDF read as str.
Datatype text_type();

void write_attribute(hid_t object, const std::string& name, const std::string& value);
void write_attribute(hid_t object, const std::string& name, double value);
void write_attribute(hid_t object, const std::string& name, unsigned long long value);

/// The value of a text attribute. Throws std::runtime_error where there is none.
std::string read_text_attribute(hid_t object, const std::string& name);

}  // namespace trebsweep::hdf5
