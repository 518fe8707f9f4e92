#pragma once

#include <mpi.h>

#include <cstdint>
#include <functional>

#include "trebsweep/job/tiling.hpp"

namespace trebsweep {

/// Numbers 0, ..., size - 1 that the ranks of a communicator share out by claiming some at a time,
/// each when it is free. Rank 0 answers the others' claims, each of which asks for its next numbers
/// before it begins with those that it has. It uses messages rather than a counter in an RMA
/// window, because Open MPI 4.1 cannot create a window if its ranks communicate through both shared
/// memory and TCP.
///
/// The constructor, finish() and the destructor are collective.
class WorkQueue {
 public:
  WorkQueue(std::uint64_t size, MPI_Comm comm);
  ~WorkQueue();
  WorkQueue(const WorkQueue&) = delete;
  WorkQueue& operator=(const WorkQueue&) = delete;

  /// Claims up to `most` consecutive numbers; none (first = end) if none are left. Towards the end
  /// fewer, so that all ranks finish at about the same time: at most a fraction of a rank's share
  /// of the rest.
  TileRange claim(std::uint64_t most);

  /// Answers other ranks' claims. Rank 0 calls it often.
  void answer();

  /// Withdraws the numbers that are not claimed yet.
  void close();

  /// Waits until no rank claims numbers any more.
  void finish();

 private:
  TileRange next(std::uint64_t most);
  void ask(std::uint64_t most);

  std::uint64_t size_, ranks_;
  MPI_Comm comm_;
  bool is_root_;
  std::uint64_t next_ = 0;      ///< on rank 0: the first number that is not claimed
  std::uint64_t finished_ = 0;  ///< on rank 0: the other ranks that were told that none are left
  TileRange answer_{0, 0};      ///< on other ranks: the answer that is being received
  MPI_Request request_ = MPI_REQUEST_NULL;
  bool is_over_ = false;  ///< on other ranks: none are left
};

/// Shares out the numbers 0, ..., size - 1: calls work(range, poll) on all ranks, each when it is
/// free, for ranges of at most `most` numbers that take about a quarter of a second; the first has
/// `first`. `work` returns how many numbers of the range it has finished, and calls poll() often,
/// which returns whether to stop. All ranks end, each after at least one number, if `stop` is true
/// after a range on any rank, or if `work` throws. Returns whether all numbers are finished. Throws
/// mpi::RootError if `work` does. Collective.
bool share_out(
    std::uint64_t size, std::uint64_t first, std::uint64_t most,
    const std::function<std::uint64_t(const TileRange&, const std::function<bool()>&)>& work,
    const std::function<bool()>& stop, MPI_Comm comm);

}  // namespace trebsweep
