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

/// Calls `read_file` in a child process. Returns whether that neither crashes nor hangs. Throws
/// std::system_error, which names the path, if that cannot be decided.
bool completes(const std::filesystem::path& path, const std::function<void()>& read_file);

/// Calls `read_file` first in a child process and then in this one. Throws std::runtime_error if it
/// does not complete there, and otherwise as completes() and `read_file` do.
template <class F>
auto read(const std::filesystem::path& path, F read_file) {
  if (!completes(path, [&] { read_file(); })) fail("HDF5 cannot read it");
  return read_file();
}

hdf5::File open(const std::filesystem::path& path);

/// Whether a text can be printed. A damaged one may hold control characters, which a terminal would
/// interpret.
bool is_printable(const std::string& text);

/// A text attribute. Throws std::runtime_error if it cannot be printed.
std::string read_text(hid_t file, const std::string& name);

}  // namespace trebsweep::untrusted
