#include "trebsweep/base/mpi.hpp"

#include <fmt/format.h>

#include <exception>
#include <stdexcept>

#include "trebsweep/base/error.hpp"

namespace trebsweep::mpi {
namespace {

std::uint64_t min(std::uint64_t value, MPI_Comm comm) {
  MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_UINT64_T, MPI_MIN, comm);
  return value;
}

}  // namespace

int rank(MPI_Comm comm) {
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  return rank;
}

int size(MPI_Comm comm) {
  int size = 0;
  MPI_Comm_size(comm, &size);
  return size;
}

std::string broadcast(std::string text, MPI_Comm comm, int root) {
  int length = static_cast<int>(text.size());
  MPI_Bcast(&length, 1, MPI_INT, root, comm);
  text.resize(static_cast<std::size_t>(length));
  MPI_Bcast(text.data(), length, MPI_CHAR, root, comm);
  return text;
}

double max(double value, MPI_Comm comm) {
  MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_DOUBLE, MPI_MAX, comm);
  return value;
}

void sum(std::span<std::uint64_t> values, MPI_Comm comm) {
  MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_UINT64_T, MPI_SUM,
                comm);
}

std::string text_of_root(MPI_Comm comm, const std::function<std::string()>& f) {
  // The first character distinguishes a result (=), an InputError (!) and another error (?).
  std::string message;
  if (rank(comm) == 0) {
    try {
      message = fmt::format("={}", f());
    } catch (const InputError& error) {
      message = fmt::format("!{}", error.what());
    } catch (const std::exception& error) {
      message = fmt::format("?{}", error.what());
    }
  }
  message = broadcast(message, comm);
  const std::string text = message.substr(1);
  if (message[0] == '!') throw InputError(text);
  if (message[0] == '?') throw RootError(text);
  return text;
}

void on_root(MPI_Comm comm, const std::function<void()>& f) {
  text_of_root(comm, [&] { return f(), std::string(); });
}

void on_all(MPI_Comm comm, const std::function<void()>& f) {
  std::string message;
  const auto ranks = static_cast<std::uint64_t>(size(comm));
  std::uint64_t failed = ranks;  // lowest rank on which f threw
  try {
    f();
  } catch (const std::exception& error) {
    message = error.what();
    failed = static_cast<std::uint64_t>(rank(comm));
  }
  failed = min(failed, comm);
  if (failed < ranks) throw RootError(broadcast(message, comm, static_cast<int>(failed)));
}

}  // namespace trebsweep::mpi
