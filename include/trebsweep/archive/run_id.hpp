#pragma once

#include <hdf5.h>

#include <cstdint>
#include <filesystem>

namespace trebsweep {

/// Identifies the run that writes a partial file, by a random number in its dataset run_id. On file
/// systems without file locking, it shows whether another run has taken the file over.
struct RunId {
  std::uint64_t id;
  std::uint64_t offset;         ///< of the number in the file, bytes
  std::uint64_t device, inode;  ///< of the file
};

/// Writes a new id to the open file with the given path; it is in the file once that is closed.
/// Throws std::runtime_error.
RunId write_run_id(hid_t file, const std::filesystem::path& path);

/// Throws std::runtime_error if the path no longer names that file, or the file no longer holds
/// that id.
void check_run_id(const RunId& run_id, const std::filesystem::path& path);

}  // namespace trebsweep
