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

TEST_CASE("Reductions combine the values of all ranks") {
  const int rank = mpi::rank(MPI_COMM_WORLD), size = mpi::size(MPI_COMM_WORLD);
  CHECK(mpi::max(rank, MPI_COMM_WORLD) == size - 1);
  std::array<std::uint64_t, 2> values{1, static_cast<std::uint64_t>(rank)};
  mpi::sum(values, MPI_COMM_WORLD);
  CHECK(values[0] == static_cast<std::uint64_t>(size));
  CHECK(values[1] == static_cast<std::uint64_t>(size * (size - 1) / 2));
  constexpr auto xor_of = [](std::uint64_t a, std::uint64_t b) { return a ^ b; };
  std::vector<std::uint64_t> bits{std::uint64_t{1} << rank, 1};
  mpi::combine<xor_of>(std::span(bits), MPI_COMM_WORLD);
  CHECK(bits[0] == (std::uint64_t{1} << size) - 1);
  CHECK(bits[1] == static_cast<std::uint64_t>(size % 2));
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
