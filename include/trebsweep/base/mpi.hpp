#pragma once

#include <mpi.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

namespace trebsweep::mpi {

// MPI's default error handler ends the run on any failure, so return codes need no checks here.

/// MPI from construction to destruction.
class Environment {
 public:
  Environment(int& argc, char**& argv) { MPI_Init(&argc, &argv); }
  ~Environment() { MPI_Finalize(); }
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;
};

int rank(MPI_Comm comm);
int size(MPI_Comm comm);

/// The text of one rank, on every rank.
std::string broadcast(std::string text, MPI_Comm comm, int root = 0);

/// Rank 0's value, on every rank.
template <class Value>
Value from_root(Value value, MPI_Comm comm) {
  static_assert(std::is_trivially_copyable_v<Value>);
  MPI_Bcast(&value, sizeof value, MPI_BYTE, 0, comm);
  return value;
}

double max(double value, MPI_Comm comm);
std::uint64_t min(std::uint64_t value, MPI_Comm comm);
double sum(double value, MPI_Comm comm);
void sum(std::span<std::uint64_t> values, MPI_Comm comm);

/// Sums that only rank 0 gets; what the others' values become is left open.
void sum_on_root(std::span<double> values, MPI_Comm comm);

/// f(0), ..., f(n - 1) on every rank, each computed by one of them in turn.
template <class F>
auto share(std::size_t n, MPI_Comm comm, F f) {
  using Result = decltype(f(n));
  static_assert(std::is_trivially_copyable_v<Result>);
  std::vector<std::byte> bytes(n * sizeof(Result));
  for (auto i = static_cast<std::size_t>(rank(comm)); i < n;
       i += static_cast<std::size_t>(size(comm))) {
    const Result result = f(i);
    std::memcpy(&bytes[i * sizeof(Result)], &result, sizeof(Result));
  }
  // What the others computed is zero here.
  MPI_Allreduce(MPI_IN_PLACE, bytes.data(), static_cast<int>(bytes.size()), MPI_BYTE, MPI_BOR,
                comm);
  std::vector<Result> results(n);
  if (n > 0) std::memcpy(results.data(), bytes.data(), bytes.size());
  return results;
}

/// A failure of one rank that all ranks know of, and can end together with.
struct RootError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Runs f on rank 0 and gives every rank the text it returns. Where f throws an InputError, every
/// rank throws it; where another exception, every rank throws a RootError with its message.
std::string text_of_root(MPI_Comm comm, const std::function<std::string()>& f);

/// The same for what returns nothing.
void on_root(MPI_Comm comm, const std::function<void()>& f);

/// Runs f on every rank. Where it throws on some, every rank throws a RootError with the message of
/// the first of them.
void on_all(MPI_Comm comm, const std::function<void()>& f);

}  // namespace trebsweep::mpi
