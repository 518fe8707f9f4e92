#include "trebsweep/archive/untrusted_file.hpp"

#include <algorithm>
#include <cctype>
#include <stdexcept>
#include <system_error>

#include "trebsweep/archive/child_process.hpp"

namespace trebsweep::untrusted {

void fail(const std::string& why) { throw std::runtime_error("damaged: " + why); }

bool completes(const std::filesystem::path& path, const std::function<void()>& read_file) {
  constexpr unsigned cpu_seconds = 10, wall_seconds = 60;  // a file system may be slow
  try {
    return completes_in_child(read_file, cpu_seconds, wall_seconds);
  } catch (const std::system_error& error) {
    throw std::system_error(error.code(), "cannot read " + path.string());
  }
}

hdf5::File open(const std::filesystem::path& path) {
  hdf5::silence();
  return {H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), "open it"};
}

bool is_printable(const std::string& text) {
  return std::none_of(text.begin(), text.end(),
                      [](unsigned char c) { return std::iscntrl(c) && c != '\n' && c != '\t'; });
}

std::string read_text(hid_t file, const std::string& name) {
  std::string text = hdf5::read_text_attribute(file, name);
  if (!is_printable(text)) fail("attribute " + name + " is not text");
  return text;
}

}  // namespace trebsweep::untrusted
