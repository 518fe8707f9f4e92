// Fuzzes the reading of existing archives, first in a child process, as `trebsweep info` does.

#include <sanitizer/common_interface_defs.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <stdexcept>
#include <string>

#include "trebsweep/archive/archive_reader.hpp"
#include "trebsweep/cli/child_process.hpp"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

/// Mostly changes bytes in place, which keeps HDF5's addresses valid. HDF5 is not instrumented for
/// coverage: only files that still look like HDF5 reach its code.
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t max_size, unsigned seed) {
  std::minstd_rand random(seed);
  if (size < 2 || random() % 8 == 0) return LLVMFuzzerMutate(data, size, max_size);
  if (random() % 16 == 0) return 1 + random() % (size - 1);  // truncate
  for (auto changes = 1 + random() % 4; changes > 0; --changes) {
    const std::size_t offset = random() % size;
    const std::size_t length = std::min<std::size_t>(1 + random() % 8, size - offset);
    LLVMFuzzerMutate(data + offset, length, length);
  }
  return size;
}

/// Whether a sanitizer has ended the child process; shared with it. Other crashes are HDF5's.
bool* const has_found = static_cast<bool*>(
    mmap(nullptr, sizeof(bool), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0));

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("fuzz_archive." + std::to_string(getpid()));
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  const auto read = [] {
    trebsweep::read_header(path);
    trebsweep::read_contents(path);
  };
  constexpr unsigned cpu_seconds = 10, wall_seconds = 60;
  const auto read_in_child = [&] {
    __sanitizer_set_death_callback([] { *has_found = true; });
    read();
  };
  if (!trebsweep::completes_in_child(read_in_child, cpu_seconds, wall_seconds)) {
    if (*has_found) std::abort();
    return 0;
  }
  try {
    read();
  } catch (const std::runtime_error&) {
  }
  return 0;
}
