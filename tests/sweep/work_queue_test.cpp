#include "trebsweep/sweep/work_queue.hpp"

#include <algorithm>
#include <chrono>
#include <functional>
#include <stdexcept>
#include <thread>
#include <vector>

#include "support/catch.hpp"
#include "trebsweep/base/mpi.hpp"

using namespace trebsweep;

namespace {

const auto never = [] { return false; };

bool is_last_rank() { return mpi::rank(MPI_COMM_WORLD) == mpi::size(MPI_COMM_WORLD) - 1; }

}  // namespace

TEST_CASE("Every number is claimed by one rank, also if ranks are unequally fast") {
  for (const std::uint64_t size : {0u, 1u, 2u, 1000u}) {
    std::vector<std::uint64_t> claims(size, 0);
    const bool all = share_out(
        size, 3, 100,
        [&](const TileRange& range, const auto&) {
          CHECK(range.end - range.first <= 100);
          for (std::uint64_t n = range.first; n < range.end; ++n) ++claims[n];
          if (is_last_rank()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
          return range.end - range.first;
        },
        never, MPI_COMM_WORLD);
    CHECK(all);
    mpi::sum(claims, MPI_COMM_WORLD);
    CHECK(claims == std::vector<std::uint64_t>(size, 1));
  }
}

TEST_CASE("Parts become smaller towards the end") {
  std::vector<std::uint64_t> parts;
  share_out(
      1000, 1000, 1000,
      [&](const TileRange& range, const auto&) {
        parts.push_back(range.end - range.first);
        return parts.back();
      },
      never, MPI_COMM_SELF);
  CHECK(parts.front() == 250);
  CHECK(std::ranges::is_sorted(parts, std::greater{}));
  CHECK(parts.back() == 1);
}

TEST_CASE("A stop on any rank ends all, and what was begun counts as finished") {
  std::uint64_t finished = 0;
  const bool all = share_out(
      1'000'000, 1, 1,
      [&](const TileRange&, const auto&) {
        std::this_thread::sleep_for(std::chrono::microseconds(100));
        return ++finished, std::uint64_t{1};
      },
      [&] { return is_last_rank() && finished >= 1; }, MPI_COMM_WORLD);
  CHECK_FALSE(all);
  if (is_last_rank()) CHECK(finished == 1);
}

TEST_CASE("An error on any rank ends all with its message") {
  const auto work = [](const TileRange&, const auto&) -> std::uint64_t {
    std::this_thread::sleep_for(std::chrono::microseconds(100));
    if (is_last_rank()) throw std::runtime_error("the disk is full");
    return 1;
  };
  CHECK_THROWS_AS(share_out(1'000'000, 1, 1, work, never, MPI_COMM_WORLD), mpi::RootError);
  CHECK_THROWS_WITH(share_out(1'000'000, 1, 1, work, never, MPI_COMM_WORLD),
                    contains("the disk is full"));
}
