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

// Return codes are not checked: MPI's default error handler aborts the run on any failure.

/// Initializes MPI, and finalizes it on destruction.
class Environment {
 public:
  Environment(int& argc, char**& argv) { MPI_Init(&argc, &argv); }
  ~Environment() { MPI_Finalize(); }
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;
};

int rank(MPI_Comm comm);
int size(MPI_Comm comm);

/// Returns the text of rank `root` on every rank.
std::string broadcast(std::string text, MPI_Comm comm, int root = 0);

/// Returns rank 0's value on every rank.
template <class Value>
Value from_root(Value value, MPI_Comm comm) {
  static_assert(std::is_trivially_copyable_v<Value>);
  MPI_Bcast(&value, sizeof value, MPI_BYTE, 0, comm);
  return value;
}

/// Reductions over all ranks, with the result on every rank; collective.
double max(double value, MPI_Comm comm);
void sum(std::span<std::uint64_t> values, MPI_Comm comm);

/// Merges arrays whose bytes are zero wherever they belong to another rank. Collective.
template <class Value>
void merge(std::span<Value> values, MPI_Comm comm) {
  static_assert(std::is_trivially_copyable_v<Value>);
  MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size_bytes()), MPI_BYTE,
                MPI_BOR, comm);
}

/// Element-wise operation(a, b), a commutative function, of the arrays of all ranks, on all ranks.
/// Collective.
template <auto operation, class Value>
void combine(std::span<Value> values, MPI_Comm comm) {
  static_assert(std::is_trivially_copyable_v<Value>);
  const auto combine_all = [](void* in, void* in_out, int* count, MPI_Datatype*) {
    for (int i = 0; i < *count; ++i) {
      auto& value = static_cast<Value*>(in_out)[i];
      value = operation(static_cast<const Value*>(in)[i], value);
    }
  };
  MPI_Datatype type;
  MPI_Type_contiguous(sizeof(Value), MPI_BYTE, &type);
  MPI_Type_commit(&type);
  MPI_Op op;
  MPI_Op_create(combine_all, 1, &op);
  MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), type, op, comm);
  MPI_Op_free(&op);
  MPI_Type_free(&type);
}

/// Returns f(0), ..., f(n - 1) on every rank; f(i) is computed by rank i % size. Collective.
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
  merge(std::span(bytes), comm);
  std::vector<Result> results(n);
  if (n > 0) std::memcpy(results.data(), bytes.data(), bytes.size());
  return results;
}

/// A failure on one rank that every rank throws, so that all ranks can end together.
struct RootError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Runs f on rank 0 and returns its text on every rank. If f throws an InputError, every rank
/// throws it; if f throws another exception, every rank throws a RootError with its message.
std::string text_of_root(MPI_Comm comm, const std::function<std::string()>& f);

/// The same for a function without a result.
void on_root(MPI_Comm comm, const std::function<void()>& f);

/// Runs f on every rank. If it throws on any of them, every rank throws a RootError with the
/// message of the lowest such rank.
void on_all(MPI_Comm comm, const std::function<void()>& f);

}  // namespace trebsweep::mpi
