#include "trebsweep/base/mpi.hpp"

#if __has_include(<catch2/catch_session.hpp>)
#include <catch2/catch_session.hpp>
#else
#define CATCH_CONFIG_RUNNER
#include <catch2/catch.hpp>
#endif

// Runs the tests on every rank. All ranks return the largest number of failures of any rank.
int main(int argc, char** argv) {
  const trebsweep::mpi::Environment environment(argc, argv);
  const int failures = Catch::Session().run(argc, argv);
  int max_failures = 0;
  MPI_Allreduce(&failures, &max_failures, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
  return max_failures;
}
