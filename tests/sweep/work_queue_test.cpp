#include "trebsweep/sweep/work_queue.hpp"

#include <chrono>
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
        size,
        [&](std::uint64_t n, const auto&) {
          ++claims[n];
          if (is_last_rank()) std::this_thread::sleep_for(std::chrono::microseconds(100));
        },
        never, MPI_COMM_WORLD);
    CHECK(all);
    mpi::sum(claims, MPI_COMM_WORLD);
    CHECK(claims == std::vector<std::uint64_t>(size, 1));
  }
}

TEST_CASE("Parts become smaller towards the end, so that unequal ranks end at the same time") {
  const double start = MPI_Wtime();
  double end = start;
  share_out(
      400,
      [&](std::uint64_t, const auto&) {
        std::this_thread::sleep_for(std::chrono::milliseconds(is_last_rank() ? 4 : 1));
        end = MPI_Wtime();
      },
      never, MPI_COMM_WORLD);
  const double longest = mpi::max(end - start, MPI_COMM_WORLD);
  CHECK(end - start > 0.75 * longest);
}

TEST_CASE("A stop on any rank ends all, and what was begun counts as finished") {
  std::uint64_t finished = 0;
  const bool all = share_out(
      1'000'000,
      [&](std::uint64_t, const auto&) {
        std::this_thread::sleep_for(std::chrono::microseconds(100));
        ++finished;
      },
      [&] { return is_last_rank() && finished >= 1; }, MPI_COMM_WORLD);
  CHECK_FALSE(all);
  if (is_last_rank()) CHECK(finished == 1);
}

TEST_CASE("An error on any rank ends all with its message") {
  const auto work = [](std::uint64_t, const auto&) {
    std::this_thread::sleep_for(std::chrono::microseconds(100));
    if (is_last_rank()) throw std::runtime_error("the disk is full");
  };
  CHECK_THROWS_AS(share_out(1'000'000, work, never, MPI_COMM_WORLD), mpi::RootError);
  CHECK_THROWS_WITH(share_out(1'000'000, work, never, MPI_COMM_WORLD),
                    contains("the disk is full"));
}
