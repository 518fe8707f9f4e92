#pragma once

#include <mpi.h>

#include <cstdint>
#include <functional>

#include "trebsweep/job/tiling.hpp"

namespace trebsweep {

/// Shares out the numbers 0, ..., size - 1 among the ranks: calls work(range, poll) on all ranks,
/// each when it is free, for ranges of at most `most` numbers that take about a quarter of a
/// second; the first has `first`. `work` returns how many numbers of the range it has finished, and
/// calls poll() often, which returns whether to stop. All ranks end, each after at least one
/// number, if `stop` is true after a range on any rank, or if `work` throws. Returns whether all
/// numbers are finished. Throws mpi::RootError if `work` does. Collective.
bool share_out(
    std::uint64_t size, std::uint64_t first, std::uint64_t most,
    const std::function<std::uint64_t(const TileRange&, const std::function<bool()>&)>& work,
    const std::function<bool()>& stop, MPI_Comm comm);

}  // namespace trebsweep
