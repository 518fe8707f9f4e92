#pragma once

#include <filesystem>
#include <span>

#include "trebsweep/archive/archive_reader.hpp"

namespace trebsweep {

/// The number of tiles to verify at once: at most 64 MiB of maps.
std::uint64_t tiles_per_verification(const ArchiveContents& contents);

/// Compares the bytes of an archive's maps with their checksums. Sets the element of `intact` of
/// each tile and map whose bytes match, and leaves the others. Throws as read_contents() does.
void verify(const std::filesystem::path& path, const ArchiveContents& contents,
            const TileRange& tiles, std::span<bool> intact);

}  // namespace trebsweep
