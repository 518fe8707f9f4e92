#pragma once

#include <hdf5.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "trebsweep/archive/hdf5.hpp"

namespace trebsweep::untrusted {

// Reading files that may be damaged, or that another program created. HDF5 crashes on some damaged
// files and hangs on others, so that they are first read in a child process.

/// Throws std::runtime_error: the file is damaged.
[[noreturn]] void fail(const std::string& why);

/// Throws std::runtime_error if `read_file` crashes or hangs in a child process, and
/// std::system_error if that cannot be decided.
void require_readable(const std::filesystem::path& path, const std::function<void()>& read_file);

/// Calls `read_file` first in a child process and then in this one. Throws as require_readable()
/// and `read_file` do.
template <class F>
auto read(const std::filesystem::path& path, F read_file) {
  require_readable(path, [&] { read_file(); });
  return read_file();
}

hdf5::File open(const std::filesystem::path& path);

/// Whether a text can be printed. A damaged one may hold control characters, which a terminal would
/// interpret.
bool is_printable(const std::string& text);

/// A text attribute. Throws std::runtime_error if it cannot be printed.
std::string read_text(hid_t file, const std::string& name);

/// The number of leading tiles that are marked done, from the values of tile_done.
std::uint64_t count_done(const std::vector<double>& done);

}  // namespace trebsweep::untrusted
