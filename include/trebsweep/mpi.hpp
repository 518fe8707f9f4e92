#pragma once

#include <mpi.h>

#include <cstdint>
#include <functional>
#include <span>
#include <string>

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

/// Rank 0's text, on every rank.
std::string broadcast(std::string text, MPI_Comm comm);

double max(double value, MPI_Comm comm);
std::uint64_t min(std::uint64_t value, MPI_Comm comm);
void sum(std::span<std::uint64_t> values, MPI_Comm comm);

/// Runs f on rank 0 and gives every rank the text it returns. Where f throws an InputError or
/// another exception, every rank throws the same kind with the same message, so that all can end
/// together.
std::string on_root(MPI_Comm comm, const std::function<std::string()>& f);

}  // namespace trebsweep::mpi
