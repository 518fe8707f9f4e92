#include "trebsweep/archive/checksum.hpp"

#include <xxhash.h>

namespace trebsweep {

std::uint64_t checksum(std::span<const std::byte> bytes, std::uint64_t seed) {
  return XXH3_64bits_withSeed(bytes.data(), bytes.size(), seed);
}

}  // namespace trebsweep
