#pragma once

#include <hdf5.h>

#include <cstdint>
#include <filesystem>

namespace trebsweep {

/// The mark that a run leaves in its partial file: a random number in the dataset run_id. Where
/// locks do not work, it shows whether another run has taken the file over.
struct RunId {
  std::uint64_t id;
  std::uint64_t offset;         ///< of the number in the file, bytes
  std::uint64_t device, inode;  ///< of the file
};

/// Marks an open file, which has that path, as this run's. The mark is on disk once the file is
/// closed. Throws std::runtime_error.
RunId write_run_id(hid_t file, const std::filesystem::path& path);

/// Throws std::runtime_error where the path names another file by now, or another run has marked
/// the file.
void check_run_id(const RunId& mark, const std::filesystem::path& path);

}  // namespace trebsweep
