// Fuzzes the reading of existing archives and partial archives.

#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <random>
#include <stdexcept>
#include <string>

#include "trebsweep/archive/archive_contents.hpp"
#include "trebsweep/archive/archive_header.hpp"
#include "trebsweep/archive/untrusted_file.hpp"

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

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("fuzz_archive." + std::to_string(getpid()));
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  try {
    trebsweep::untrusted::read(path, [&] {
      trebsweep::read_archive_header(path);
      return trebsweep::read_contents(path).tally();
    });
  } catch (const std::runtime_error&) {
  }
  return 0;
}
