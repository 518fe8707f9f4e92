#include "trebsweep/archive/hdf5.hpp"

#include <algorithm>
#include <stdexcept>
#include <string_view>

namespace trebsweep::hdf5 {
namespace {

/// Stores the innermost message of the error stack, which is the cause.
herr_t store_cause(unsigned n, const H5E_error2_t* error, void* reason) {
  if (n == 0 && error->desc) *static_cast<std::string*>(reason) = error->desc;
  return 0;
}

/// Creates an attribute; `type` and `memory_type` are those in the file and of `values`.
void write(hid_t object, const std::string& name, const Dataspace& space, hid_t type,
           hid_t memory_type, const void* values) {
  const std::string what = "write attribute " + name;
  const Attribute attribute(H5Acreate2(object, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT),
                            what);
  check(H5Awrite(attribute, memory_type, values), what);
}

void write(hid_t object, const std::string& name, hid_t type, const void* value) {
  write(object, name, {H5Screate(H5S_SCALAR), "write an attribute"}, type, type, value);
}

/// Opens an attribute that must have one value.
Attribute open_single(hid_t object, const std::string& name, const std::string& what) {
  Attribute attribute(H5Aopen(object, name.c_str(), H5P_DEFAULT), what);
  const Dataspace space(H5Aget_space(attribute), what);
  if (H5Sget_simple_extent_npoints(space) != 1) fail(what + ": not a single value");
  return attribute;
}

}  // namespace

void silence() {
  check(H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr), "silence HDF5's own messages");
}

void fail(const std::string& what) {
  std::string reason;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, store_cause, &reason);
  // Of an error of the operating system, keep only its own message.
  const std::string_view system_message = "error message = '";
  if (const auto start = reason.find(system_message); start != reason.npos) {
    reason.erase(0, start + system_message.size());
    reason.erase(std::min(reason.find('\''), reason.size()));
  }
  throw std::runtime_error("cannot " + what + (reason.empty() ? "" : ": " + reason));
}

File open_parallel(const std::filesystem::path& path, MPI_Comm comm) {
  const std::string what = "open " + path.string();
  const Properties access(H5Pcreate(H5P_FILE_ACCESS), what);
  check(H5Pset_fapl_mpio(access, comm, MPI_INFO_NULL), what);
  return {H5Fopen(path.c_str(), H5F_ACC_RDWR, access), what};
}

Dataset open_dataset(hid_t file, const std::string& name) {
  return {H5Dopen2(file, name.c_str(), H5P_DEFAULT), "open " + name};
}

Dataset create_dataset(hid_t file, const std::string& name, hid_t type,
                       std::span<const hsize_t> extents, hid_t properties) {
  const std::string what = "create " + name;
  const Dataspace space(H5Screate_simple(static_cast<int>(extents.size()), extents.data(), nullptr),
                        what);
  return {H5Dcreate2(file, name.c_str(), type, space, H5P_DEFAULT, properties, H5P_DEFAULT), what};
}

Properties with_checksum(std::span<const hsize_t> extents) {
  const std::string what = "set up a dataset with a checksum";
  Properties properties(H5Pcreate(H5P_DATASET_CREATE), what);
  if (extents.empty()) return properties;
  check(H5Pset_chunk(properties, static_cast<int>(extents.size()), extents.data()), what);
  check(H5Pset_fletcher32(properties), what);
  return properties;
}

Selection select(hid_t dataset, std::span<const hsize_t> first, std::span<const hsize_t> count) {
  const std::string what = "select a block";
  Selection selected{
      {H5Dget_space(dataset), what},
      {H5Screate_simple(static_cast<int>(count.size()), count.data(), nullptr), what}};
  check(H5Sselect_hyperslab(selected.file, H5S_SELECT_SET, first.data(), nullptr, count.data(),
                            nullptr),
        what);
  return selected;
}

Datatype text_type() {
  Datatype type(H5Tcopy(H5T_C_S1), "make a text type");
  check(H5Tset_size(type, H5T_VARIABLE), "make a text type");
  check(H5Tset_cset(type, H5T_CSET_UTF8), "make a text type");
  return type;
}

void write_attribute(hid_t object, const std::string& name, const std::string& value) {
  const char* text = value.c_str();
  write(object, name, text_type(), &text);
}

void write_attribute(hid_t object, const std::string& name, double value) {
  write(object, name, H5T_NATIVE_DOUBLE, &value);
}

void write_attribute(hid_t object, const std::string& name, std::uint64_t value) {
  write(object, name, H5T_NATIVE_UINT64, &value);
}

void write_attribute(hid_t object, const std::string& name, hid_t type,
                     std::span<const double> values) {
  const hsize_t count = values.size();
  write(object, name, {H5Screate_simple(1, &count, nullptr), "write an attribute"}, type,
        H5T_NATIVE_DOUBLE, values.data());
}

std::string read_text_attribute(hid_t object, const std::string& name) {
  const std::string what = "read attribute " + name;
  const Attribute attribute = open_single(object, name, what);
  char* text = nullptr;
  check(H5Aread(attribute, text_type(), &text), what);
  const std::string value(text ? text : "");
  H5free_memory(text);
  return value;
}

double read_number_attribute(hid_t object, const std::string& name) {
  const std::string what = "read attribute " + name;
  double value = 0;
  check(H5Aread(open_single(object, name, what), H5T_NATIVE_DOUBLE, &value), what);
  return value;
}

std::vector<std::string> link_names(hid_t group) {
  std::vector<std::string> names;
  const auto add = [](hid_t, const char* name, const H5L_info_t*, void* all) {
    static_cast<std::vector<std::string>*>(all)->push_back(name);
    return herr_t{0};
  };
  check(H5Literate(group, H5_INDEX_NAME, H5_ITER_INC, nullptr, add, &names), "list its members");
  return names;
}

std::vector<hsize_t> extents(hid_t dataset) {
  const Dataspace space(H5Dget_space(dataset), "read the extents of a dataset");
  const int rank = H5Sget_simple_extent_ndims(space);
  std::vector<hsize_t> extents(static_cast<std::size_t>(std::max(rank, 0)));
  if (rank > 0) H5Sget_simple_extent_dims(space, extents.data(), nullptr);
  return extents;
}

std::size_t count_values(hid_t file, hid_t dataset) {
  const std::string what = "read a dataset";
  const Dataspace space(H5Dget_space(dataset), what);
  const Datatype type(H5Dget_type(dataset), what);
  const hssize_t count = H5Sget_simple_extent_npoints(space);
  hsize_t bytes = 0;
  check(H5Fget_filesize(file, &bytes), what);
  // A damaged extent must not make us allocate more memory than the file could fill.
  if (count < 0 || static_cast<hsize_t>(count) > bytes / std::max<hsize_t>(1, H5Tget_size(type)))
    throw std::runtime_error("cannot " + what + ": larger than the file");
  return static_cast<std::size_t>(count);
}

}  // namespace trebsweep::hdf5
