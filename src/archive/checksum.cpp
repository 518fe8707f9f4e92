#include "trebsweep/archive/checksum.hpp"

#include <xxhash.h>

namespace trebsweep {

std::uint64_t checksum(std::span<const std::byte> bytes) {
  return XXH3_64bits(bytes.data(), bytes.size());
}

}  // namespace trebsweep
