#pragma once

#include <boost/interprocess/mapped_region.hpp>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <span>
#include <vector>

// What a sweep writes, and when
//
// An archive FILE is written once, when all its designs are done. Until then the results are in the
// folder FILE.partial:
//
//   lock                   locked by rank 0 of the run that is active, and names it
//   sweep.json             the job, the version of the numerics, the tiles, and the history;
//                          sweep.json.new while it is written
//   RUN-RANK.journal       the results of one rank in one run
//   archive.h5             the archive while it is written
//
//   start        rank 0 creates and locks the folder and writes sweep.json under another name,
//                then renames it; a run that resumes adds its line to the history
//   sweep        a rank claims tiles, computes them, and appends a record of each to its journal,
//                in memory; every second, or when 64 MiB have gathered, it writes the records
//                to the file. No rank waits for another, and nothing in a file changes later.
//   stop         at a signal or the time limit, a rank finishes its current tile, writes its
//                journal, and calls fsync
//   end          the ranks write archive.h5 from the records and call fsync; rank 0 renames it to
//                FILE, and removes the folder, sweep.json and the lock last
//
// A record is a header, which has the number of a tile or a scene, and the results as the archive
// stores them. The header has a checksum of the sweep's job and tiles, of itself, and of the
// results, so that records of another sweep are never used. A record that does not match its
// checksum is ignored, and what it held is computed again: the last one of a run that was killed
// while it wrote, or one that the disk has damaged. The search for the next record continues at the
// next mark, with which every header begins.
//
// What is lost
//
//   a kill during the start    nothing: the next run starts again
//   a kill during the sweep    what the ranks have computed since they last wrote: a second, and
//                              the tiles in progress, which take about a second at most. Written
//                              records are in the operating system's cache and do not depend on the
//                              process.
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

struct Record {
  std::uint64_t number;  ///< of the tile, or the number of tiles plus that of the scene
  std::span<const std::byte> results;
};

/// The size of what precedes the results in a record.
inline constexpr std::size_t record_header_bytes = 32;

/// The intact records of a sweep in a journal, in their order. They refer to its bytes.
std::vector<Record> intact_records(std::span<const std::byte> journal, std::uint64_t sweep);

/// A file in memory, read-only; none if it is empty. Throws std::runtime_error if the file cannot
/// be read.
using MappedFile = boost::interprocess::mapped_region;
MappedFile map_file(const std::filesystem::path& path);
std::span<const std::byte> bytes_of(const MappedFile& file);

/// The journal that a rank writes. Member functions throw std::runtime_error if the file cannot be
/// written.
class Journal {
 public:
  /// The file is created when it is first written. `sweep` identifies the sweep.
  Journal(std::filesystem::path path, std::uint64_t sweep)
      : path_(std::move(path)), sweep_(sweep) {}

  /// Adds a record in memory.
  void append(std::uint64_t number, std::vector<std::byte> results);

  /// The size of the records in memory.
  std::size_t unwritten_bytes() const { return unwritten_bytes_; }

  /// Writes the records in memory to the file.
  void write();

  /// Does so and waits until the file is on disk.
  void sync();

  /// All records, which are valid until the next call of a member function.
  std::vector<Record> records();

 private:
  struct Unwritten {
    std::uint64_t number;
    std::vector<std::byte> results;
  };

  std::filesystem::path path_;
  std::uint64_t sweep_;
  std::ofstream file_;
  std::vector<Unwritten> unwritten_;
  std::size_t unwritten_bytes_ = 0;
  MappedFile written_;  // the file, as far as records() refers to it
};

}  // namespace trebsweep
