#pragma once

#include <filesystem>
#include <span>

#include "trebsweep/archive/archive_reader.hpp"

namespace trebsweep {

/// The number of tiles to verify at once: at most 64 MiB of maps.
std::uint64_t tiles_per_verification(const ArchiveContents& contents);

/// Compares the bytes of an archive's tiles with their checksums. Sets the element of `intact` of
/// each tile and column of tile_checksum whose bytes match, and leaves the others. The optimum of a
/// scene belongs to its last tile. Throws as read_contents() does.
void verify(const std::filesystem::path& path, const ArchiveContents& contents,
            const TileRange& tiles, std::span<bool> intact);

}  // namespace trebsweep
