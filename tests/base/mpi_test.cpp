#include "trebsweep/base/mpi.hpp"

#include "support/catch.hpp"
#include "trebsweep/base/error.hpp"

using namespace trebsweep;

TEST_CASE("broadcast gives every rank the text of rank 0") {
  const std::string text = mpi::rank(MPI_COMM_WORLD) == 0 ? "from the root" : "";
  CHECK(mpi::broadcast(text, MPI_COMM_WORLD) == "from the root");
  CHECK(mpi::broadcast("", MPI_COMM_WORLD).empty());
}

TEST_CASE("from_root gives every rank the value of rank 0") {
  const std::array<double, 2> value{0.5 * mpi::rank(MPI_COMM_WORLD), 5};
  CHECK(mpi::from_root(value, MPI_COMM_WORLD) == std::array<double, 2>{0, 5});
}

TEST_CASE("Reductions combine the values of all ranks; sum_on_root gives rank 0 the result") {
  const int rank = mpi::rank(MPI_COMM_WORLD), size = mpi::size(MPI_COMM_WORLD);
  CHECK(mpi::max(rank, MPI_COMM_WORLD) == size - 1);
  std::array<std::uint64_t, 2> values{1, static_cast<std::uint64_t>(rank)};
  mpi::sum(values, MPI_COMM_WORLD);
  CHECK(values[0] == static_cast<std::uint64_t>(size));
  CHECK(values[1] == static_cast<std::uint64_t>(size * (size - 1) / 2));
  std::array<double, 2> numbers{0.5, static_cast<double>(rank)};
  mpi::sum_on_root(numbers, MPI_COMM_WORLD);
  if (rank == 0) CHECK(numbers == std::array<double, 2>{0.5 * size, size * (size - 1) / 2.0});
  constexpr std::uint64_t large = ~std::uint64_t{0};  // not a double
  std::array<std::uint64_t, 1> one_each{rank == size - 1 ? large : 0};
  mpi::sum_on_root(one_each, MPI_COMM_WORLD);
  if (rank == 0) CHECK(one_each[0] == large);
}

TEST_CASE("Every rank returns or throws what rank 0 returns or throws") {
  int calls = 0;
  const auto text = mpi::text_of_root(MPI_COMM_WORLD, [&] { return ++calls, std::string("done"); });
  CHECK(text == "done");
  CHECK(calls == (mpi::rank(MPI_COMM_WORLD) == 0));
  CHECK_THROWS_AS(
      mpi::text_of_root(MPI_COMM_WORLD, []() -> std::string { throw InputError("bad key"); }),
      InputError);
  const auto fail = [] { mpi::on_root(MPI_COMM_WORLD, [] { throw std::runtime_error("disk"); }); };
  CHECK_THROWS_WITH(fail(), "disk");
  CHECK_THROWS_AS(fail(), mpi::RootError);
}

TEST_CASE("share gives every rank the results of all ranks, in order") {
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
