// Fuzzes what is read of a file that is there already under an archive's name, or as its partial.

#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <random>
#include <stdexcept>
#include <string>

#include "trebsweep/archive/archive_contents.hpp"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

/// Mostly damage in place, which leaves HDF5's addresses where they were: its code, which tells the
/// fuzzer nothing of its coverage, is reached by what still looks like its file.
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t most, unsigned seed) {
  std::minstd_rand random(seed);
  if (size < 2 || random() % 8 == 0) return LLVMFuzzerMutate(data, size, most);
  if (random() % 16 == 0) return 1 + random() % (size - 1);  // cut off
  for (auto changes = 1 + random() % 4; changes > 0; --changes) {
    const std::size_t place = random() % size;
    const std::size_t length = std::min<std::size_t>(1 + random() % 8, size - place);
    LLVMFuzzerMutate(data + place, length, length);
  }
  return size;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("fuzz_archive." + std::to_string(getpid()));
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  try {
    trebsweep::read_archive_header(path);
    trebsweep::read_contents(path);
  } catch (const std::runtime_error&) {
  }
  return 0;
}
