#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace trebsweep {

/// The 64-bit XXH3 checksum of bytes.
std::uint64_t checksum(std::span<const std::byte> bytes, std::uint64_t seed = 0);

}  // namespace trebsweep
