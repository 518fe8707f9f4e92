#include "trebsweep/sweep/work_queue.hpp"

#include <algorithm>
#include <chrono>
#include <thread>

#include "trebsweep/base/mpi.hpp"
#include "trebsweep/job/tiling.hpp"
#include "trebsweep/sweep/schedule.hpp"

namespace trebsweep {
namespace {

/// Numbers 0, ..., size - 1 that the ranks of a communicator share out by claiming some at a time,
/// each when it is free. Rank 0 answers the others' claims, each of which asks for its next numbers
/// before it begins with those that it has. It uses messages rather than a counter in an RMA
/// window, because Open MPI 4.1 cannot create a window if its ranks communicate through both shared
/// memory and TCP. The constructor, finish() and the destructor are collective.
class WorkQueue {
 public:
  WorkQueue(std::uint64_t size, MPI_Comm comm)
      : size_(size),
        ranks_(static_cast<std::uint64_t>(mpi::size(comm))),
        is_root_(mpi::rank(comm) == 0) {
    MPI_Comm_dup(comm, &comm_);
  }
  ~WorkQueue() { MPI_Comm_free(&comm_); }
  WorkQueue(const WorkQueue&) = delete;
  WorkQueue& operator=(const WorkQueue&) = delete;

  /// Claims up to `most` consecutive numbers; none (first = end) if none are left. Towards the end
  /// fewer, so that all ranks finish at about the same time: at most a fraction of a rank's share
  /// of the rest.
  TileRange claim(std::uint64_t most) {
    if (is_root_) {
      answer();
      return next(most);
    }
    if (is_over_) return {size_, size_};
    if (request_ == MPI_REQUEST_NULL) ask(most);
    MPI_Wait(&request_, MPI_STATUS_IGNORE);
    const TileRange range = answer_;
    is_over_ = range.first == range.end;
    if (!is_over_) ask(most);
    return range;
  }

  /// Answers other ranks' claims. Rank 0 calls it often.
  void answer() {
    for (int found = 1; is_root_ && found;) {
      MPI_Status status;
      MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, comm_, &found, &status);
      if (found) answer(status.MPI_SOURCE, status.MPI_TAG);
    }
  }

  /// Withdraws the numbers that are not claimed yet.
  void close() {
    next_ = size_;
    if (!is_root_) MPI_Send(&next_, 1, MPI_UINT64_T, 0, close_tag, comm_);
  }

  /// Waits until no rank claims numbers any more.
  void finish() {
    if (!is_root_)
      while (!is_over_) claim(1);
    else
      for (answer(); finished_ + 1 < ranks_; answer())
        std::this_thread::sleep_for(std::chrono::microseconds(100));
  }

 private:
  TileRange next(std::uint64_t most) {
    const std::uint64_t first = next_, left = size_ - first;
    next_ += std::min(left, std::clamp<std::uint64_t>(left / (4 * ranks_), 1, most));
    return {first, next_};
  }

  void ask(std::uint64_t most) {
    MPI_Irecv(&answer_, sizeof answer_, MPI_BYTE, 0, answer_tag, comm_, &request_);
    MPI_Send(&most, 1, MPI_UINT64_T, 0, claim_tag, comm_);
  }

  void answer(int rank, int tag) {
    std::uint64_t most = 0;
    MPI_Recv(&most, 1, MPI_UINT64_T, rank, tag, comm_, MPI_STATUS_IGNORE);
    if (tag == close_tag) return close();
    const TileRange range = next(most);
    finished_ += range.first == range.end;
    MPI_Send(&range, sizeof range, MPI_BYTE, rank, answer_tag, comm_);
  }

  static constexpr int claim_tag = 1, close_tag = 2, answer_tag = 3;

  std::uint64_t size_, ranks_;
  MPI_Comm comm_;
  bool is_root_;
  std::uint64_t next_ = 0;      // on rank 0: the first number that is not claimed
  std::uint64_t finished_ = 0;  // on rank 0: the other ranks that were told that none are left
  TileRange answer_{0, 0};      // on other ranks: the answer that is being received
  MPI_Request request_ = MPI_REQUEST_NULL;
  bool is_over_ = false;  // on other ranks: none are left
};

}  // namespace

bool share_out(std::uint64_t size,
               const std::function<void(std::uint64_t, const std::function<void()>&)>& work,
               const std::function<bool()>& stop, MPI_Comm comm) {
  constexpr double target_seconds = 0.25;
  WorkQueue queue(size, comm);
  const auto poll = [&] { queue.answer(); };
  std::uint64_t finished = 0, part = 1;
  const auto work_on = [&] {
    for (TileRange range = queue.claim(part); range.first < range.end; range = queue.claim(part)) {
      const double start = MPI_Wtime();
      for (std::uint64_t n = range.first; n < range.end; ++n) {
        work(n, poll);
        ++finished;
        poll();
        if (stop()) return queue.close();
      }
      part = next_count(range.end - range.first, MPI_Wtime() - start, target_seconds);
    }
  };
  mpi::on_all(comm, [&] {
    try {
      work_on();
    } catch (...) {
      queue.close();
      queue.finish();
      throw;
    }
    queue.finish();
  });
  mpi::sum({&finished, 1}, comm);
  return finished == size;
}

}  // namespace trebsweep
