// Initializes MPI before the first test of a program and finalizes it after the last one. Each rank
// returns its own failures; mpirun fails if any rank does.

#if __has_include(<catch2/catch_all.hpp>)
#include <catch2/catch_all.hpp>
using Listener = Catch::EventListenerBase;
#else
#define CATCH_CONFIG_EXTERNAL_INTERFACES
#include <catch2/catch.hpp>
using Listener = Catch::TestEventListenerBase;
#endif

#include <mpi.h>

namespace {

struct MpiRun : Listener {
  using Listener::Listener;
  void testRunStarting(const Catch::TestRunInfo& info) override {
    Listener::testRunStarting(info);
    MPI_Init(nullptr, nullptr);
  }
  void testRunEnded(const Catch::TestRunStats& stats) override {
    Listener::testRunEnded(stats);
    MPI_Finalize();
  }
};

}  // namespace

CATCH_REGISTER_LISTENER(MpiRun)
