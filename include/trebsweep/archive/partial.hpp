#pragma once

#include <mpi.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "trebsweep/archive/output_path.hpp"
#include "trebsweep/archive/run_id.hpp"
#include "trebsweep/archive/skeleton.hpp"

// What a sweep writes, and when
//
//   creation     <path>.partial.new: axes, maps of fill values, attributes; rename it to
//                <path>.partial
//   each round   1. every rank writes its tiles to the maps
//                2. rank 0 writes the optima of the scenes whose last tile is in the round to
//                   best_value, best_speed, ..., the tallies of the round's tiles to tile_tally,
//                   and the checksums of tiles, optima and tallies to tile_checksum
//                3. flush
//                4. rank 0 marks the round's tiles as done in tile_done
//                5. flush
//   completion   write the summary attributes, flush, close, rename <path>.partial to <path>
//
// Steps 2 to 5 are the checkpoint. Only tiles before the first unmarked one count as done. A run
// that is killed loses
//
//   during creation            the new file, which the next run replaces
//   before step 4 of a round   that round: the next run computes and writes its tiles again
//   during steps 4 and 5       that round at most
//   after step 5               nothing
//   during completion          nothing: the next run of the same command finishes the archive
//
// The order survives a kill. A write that has returned is in the operating system's cache and does
// not depend on the process; rank 0 marks tiles only after the writes of all ranks have returned.
// HDF5, however, keeps its metadata, such as the index of compressed chunks, in memory until a
// flush: without step 3 a tile could be marked whose data cannot be found. Uncompressed chunks are
// allocated at creation and written in place. Compressed chunks move when they are written, but
// freed space is never reused, so that an index that is out of date still points to valid chunks.
//
// A flush writes the superblock last. A kill before the end of step 3 may thus leave an index that
// points to new chunks, and a superblock that stores the file's size without them: HDF5 would
// refuse to read these chunks, and would cut them off when it next writes the file.
// continue_partial() therefore stores the actual size first. Tiles marked done are not affected:
// they are marked after the flush of step 3, superblock included, and steps 4 and 5 write in place.
// A damaged tile that is computed again keeps its mark; if it cannot be read after a kill, it is
// damaged again.
//
// It need not survive a node that loses power. A flush ends with an fsync on every rank and a
// barrier, so that data precedes its marks on disk as far as the file system honours fsync. But
// between two flushes the system may write to disk in any order: if power fails during a
// checkpoint, HDF5's metadata may be written in part, in which case the next run reports a damaged
// file. Arbitrary bytes in unmarked tiles do no harm: the next run overwrites them.

namespace trebsweep {

/// Creates the partial file, in which every cell has the fill value of its map, and replaces an
/// existing one. No incomplete file ever has the name <path>.partial. The attributes are taken from
/// rank 0. Returns the id of this run on all ranks, or nothing if any rank was stopped. Throws
/// InputError if the disk is known to have too little space, and mpi::RootError if it fails
/// otherwise. Leaves no file behind if it is stopped or throws. Collective.
std::optional<RunId> create_partial(const std::filesystem::path& path, const Skeleton& skeleton,
                                    const ProgressCallback& progress, MPI_Comm comm);

/// Prepares a partial file for another run, which computes the given tiles, and adds a line to its
/// history. For one rank. Throws std::runtime_error.
RunId continue_partial(const std::filesystem::path& path, const Study& study, const Tiling& tiling,
                       const std::vector<MapInfo>& maps, const std::vector<TileRange>& to_compute,
                       const std::string& history_line);

/// Throws mpi::RootError if a rank cannot see a file, as when ranks run in different directories or
/// on file systems that they do not share. Collective.
void require_visible(const std::filesystem::path& path, MPI_Comm comm);

/// Renames the complete partial file to its final name. `replaces` is as in rename_to_final(). For
/// one rank. Throws std::runtime_error, also if another run has taken the file over.
void finish_partial(const std::filesystem::path& path, const RunId& run_id,
                    const std::string& replaces);

/// Renames a file. Throws std::runtime_error if the new name belongs to any file except the one
/// whose file_identity() is `replaces`.
void rename_to_final(const std::filesystem::path& from, const std::filesystem::path& to,
                     const std::string& replaces);

/// Calls `write`, which writes to a partial file. Adds to the message of a failure the file's path,
/// a limit of space that was reached, and that the sweep can be continued.
void write_partial(const std::filesystem::path& partial, const std::function<void()>& write);

}  // namespace trebsweep
