#include "trebsweep/sweep/work_queue.hpp"

#include <algorithm>
#include <chrono>
#include <thread>

#include "trebsweep/base/mpi.hpp"
#include "trebsweep/sweep/schedule.hpp"

namespace trebsweep {
namespace {

constexpr int claim_tag = 1, close_tag = 2, answer_tag = 3;

}  // namespace

WorkQueue::WorkQueue(std::uint64_t size, MPI_Comm comm)
    : size_(size),
      ranks_(static_cast<std::uint64_t>(mpi::size(comm))),
      is_root_(mpi::rank(comm) == 0) {
  MPI_Comm_dup(comm, &comm_);
}

WorkQueue::~WorkQueue() { MPI_Comm_free(&comm_); }

TileRange WorkQueue::next(std::uint64_t most) {
  const std::uint64_t first = next_, left = size_ - first;
  next_ += std::min(left, std::clamp<std::uint64_t>(left / (4 * ranks_), 1, most));
  return {first, next_};
}

void WorkQueue::ask(std::uint64_t most) {
  MPI_Irecv(&answer_, sizeof answer_, MPI_BYTE, 0, answer_tag, comm_, &request_);
  MPI_Send(&most, 1, MPI_UINT64_T, 0, claim_tag, comm_);
}

TileRange WorkQueue::claim(std::uint64_t most) {
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

void WorkQueue::answer() {
  if (!is_root_) return;
  for (;;) {
    int found = 0;
    MPI_Status status;
    MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, comm_, &found, &status);
    if (!found) return;
    std::uint64_t most = 0;
    MPI_Recv(&most, 1, MPI_UINT64_T, status.MPI_SOURCE, status.MPI_TAG, comm_, MPI_STATUS_IGNORE);
    if (status.MPI_TAG == close_tag) {
      next_ = size_;
      continue;
    }
    const TileRange range = next(most);
    finished_ += range.first == range.end;
    MPI_Send(&range, sizeof range, MPI_BYTE, status.MPI_SOURCE, answer_tag, comm_);
  }
}

void WorkQueue::close() {
  next_ = size_;
  if (!is_root_) MPI_Send(&next_, 1, MPI_UINT64_T, 0, close_tag, comm_);
}

void WorkQueue::finish() {
  if (!is_root_)
    while (!is_over_) claim(1);
  else
    for (answer(); finished_ + 1 < ranks_; answer())
      std::this_thread::sleep_for(std::chrono::microseconds(100));
}

bool share_out(
    std::uint64_t size, std::uint64_t first, std::uint64_t most,
    const std::function<std::uint64_t(const TileRange&, const std::function<bool()>&)>& work,
    const std::function<bool()>& stop, MPI_Comm comm) {
  constexpr double target_seconds = 0.25;
  WorkQueue queue(size, comm);
  const auto poll = [&] {
    queue.answer();
    return stop();
  };
  std::uint64_t finished = 0, part = std::clamp<std::uint64_t>(first, 1, most);
  const auto work_on = [&] {
    for (TileRange range = queue.claim(part); range.first < range.end; range = queue.claim(part)) {
      const double start = MPI_Wtime();
      const std::uint64_t count = range.end - range.first, done = work(range, poll);
      finished += done;
      if (done < count || stop()) return queue.close();
      part = std::min(next_count(count, MPI_Wtime() - start, target_seconds), most);
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
