#pragma once

#include <mpi.h>

#include <cstdint>
#include <functional>

namespace trebsweep {

/// Shares out the numbers 0, ..., size - 1 among the ranks: calls work(number, poll) for each on
/// one of them. A rank that is free claims consecutive numbers, at first one, later as many as take
/// about a quarter of a second. `work` calls poll() often. All ranks end, each after at least one
/// number, if `stop` is true after a number on any rank, or if `work` throws. Returns whether all
/// numbers are finished. Throws mpi::RootError if `work` does. Collective.
bool share_out(std::uint64_t size,
               const std::function<void(std::uint64_t, const std::function<void()>&)>& work,
               const std::function<bool()>& stop, MPI_Comm comm);

}  // namespace trebsweep
