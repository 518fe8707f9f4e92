#pragma once

#include <boost/interprocess/file_mapping.hpp>
#include <boost/interprocess/mapped_region.hpp>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

// What a sweep writes, and when
//
// An archive FILE is written once, when all its designs are done. Until then the results are in the
// folder FILE.partial:
//
//   sweep.json             the job, the version of the numerics, the tiles, and the history
//   RUN-RANK.journal       the results of one rank in one run
//   archive.h5             the archive while it is written
//
//   start        rank 0 creates the folder and sweep.json, which it writes under another name and
//                renames; a run that resumes adds its line to the history
//   sweep        a rank claims tiles, computes them, and appends a record of each to its journal,
//                in memory; every two seconds, or when 64 MiB have gathered, it writes the records
//                to the file. No rank waits for another, and nothing in a file changes later.
//   stop         at a signal or the time limit, a rank finishes its current tile, writes its
//                journal, and calls fsync
//   end          the ranks write archive.h5 from the records; rank 0 calls fsync, renames it to
//                FILE, and removes the folder
//
// A record is a header, which has the number of a tile or a scene, and the results as the archive
// stores them. The header has a checksum of itself and of the results. A record that does not match
// its checksum is ignored, and what it held is computed again: the last one of a run that was
// killed while it wrote, or one that the disk has damaged. The search for the next record continues
// at the next mark, with which every header begins.
//
// What is lost
//
//   a kill during the start    nothing: the next run starts again
//   a kill during the sweep    what the ranks have computed since they last wrote: two seconds and
//                              the tiles in progress. Written records are in the operating system's
//                              cache and do not depend on the process.
//   a stop                     nothing
//   a kill during the end      only records that were still in memory, as during the sweep: the
//                              next run computes them and writes the archive again
//   a kill after the renaming  nothing: the next run finds the archive and removes the folder
//   a full disk                as much as by a kill; a message names the cause
//   a loss of power            the records that the system has not yet written to the disk (Linux
//                              waits up to 30 s). They may be damaged or missing, in any order,
//                              which their checksums show. The archive is complete once it has its
//                              name, as far as the file system honours fsync.

namespace trebsweep {

/// What a record holds: the results of a tile, or the optimum of a scene.
enum class RecordKind : std::uint32_t { tile, scene };

struct Record {
  RecordKind kind;
  std::uint64_t number;  ///< of the tile or the scene
  std::span<const std::byte> results;
};

/// The intact records of a journal, in their order. They refer to its bytes.
std::vector<Record> intact_records(std::span<const std::byte> journal);

/// A file in memory, read-only.
class MappedFile {
 public:
  /// Throws std::runtime_error if the file cannot be read.
  explicit MappedFile(const std::filesystem::path& path);

  std::span<const std::byte> bytes() const;

 private:
  boost::interprocess::mapped_region region_;  // none for an empty file
};

/// The journal that a rank writes. Member functions throw std::runtime_error if the file cannot be
/// written.
class Journal {
 public:
  /// The file is created when it is first written; it must not exist.
  explicit Journal(std::filesystem::path path) : path_(std::move(path)) {}
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  /// Adds a record in memory.
  void append(const Record& record);

  /// The size of the records in memory.
  std::size_t unwritten_bytes() const { return unwritten_.size(); }

  /// Writes the records in memory to the file.
  void write();

  /// Does so and waits until the file is on disk.
  void sync();

  /// All records, which are valid until the next call of a member function.
  std::vector<Record> records();

 private:
  std::filesystem::path path_;
  int file_ = -1;
  std::vector<std::byte> unwritten_;
  std::vector<MappedFile> written_;  // at most one
};

}  // namespace trebsweep
