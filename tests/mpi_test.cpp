#include "trebsweep/mpi.hpp"

#include "catch.hpp"
#include "trebsweep/error.hpp"

using namespace trebsweep;

TEST_CASE("A text of rank 0 reaches every rank") {
  const std::string text = mpi::rank(MPI_COMM_WORLD) == 0 ? "from the root" : "";
  CHECK(mpi::broadcast(text, MPI_COMM_WORLD) == "from the root");
  CHECK(mpi::broadcast("", MPI_COMM_WORLD).empty());
}

TEST_CASE("Reductions are over all ranks, with the result on all") {
  const int rank = mpi::rank(MPI_COMM_WORLD), size = mpi::size(MPI_COMM_WORLD);
  CHECK(mpi::max(rank, MPI_COMM_WORLD) == size - 1);
  CHECK(mpi::min(static_cast<std::uint64_t>(rank) + 7, MPI_COMM_WORLD) == 7);
  std::array<std::uint64_t, 2> values{1, static_cast<std::uint64_t>(rank)};
  mpi::sum(values, MPI_COMM_WORLD);
  CHECK(values[0] == static_cast<std::uint64_t>(size));
  CHECK(values[1] == static_cast<std::uint64_t>(size * (size - 1) / 2));
}

TEST_CASE("What rank 0 returns or throws is returned or thrown everywhere") {
  int calls = 0;
  const auto text = mpi::on_root(MPI_COMM_WORLD, [&] { return ++calls, std::string("done"); });
  CHECK(text == "done");
  CHECK(calls == (mpi::rank(MPI_COMM_WORLD) == 0));
  CHECK_THROWS_AS(
      mpi::on_root(MPI_COMM_WORLD, []() -> std::string { throw InputError("bad key"); }),
      InputError);
  CHECK_THROWS_WITH(
      mpi::on_root(MPI_COMM_WORLD, []() -> std::string { throw std::runtime_error("disk"); }),
      "disk");
}

TEST_CASE("What ranks compute in turn is known to all of them") {
  struct Result {
    std::size_t n;
    double half;
    char kind;
  };
  for (const std::size_t count : {0, 1, 2, 7}) {
    const auto results = mpi::share(count, MPI_COMM_WORLD, [](std::size_t n) {
      return Result{n, static_cast<double>(n) / 2, 'x'};
    });
    REQUIRE(results.size() == count);
    for (std::size_t n = 0; n < count; ++n) {
      CHECK(results[n].n == n);
      CHECK(results[n].half == static_cast<double>(n) / 2);
      CHECK(results[n].kind == 'x');
    }
  }
}
