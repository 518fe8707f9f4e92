#include "trebsweep/cli/stop_signals.hpp"

#include <signal.h>

#include "support/catch.hpp"

using namespace trebsweep;

TEST_CASE("Each of the signals requests a stop, and a new instance starts without a request") {
  for (const int number : {SIGINT, SIGTERM, SIGUSR1}) {
    const StopSignals signals;
    CHECK_FALSE(signals.requested());
    raise(number);
    CHECK(signals.requested());
    raise(number);
    CHECK(signals.requested());
  }
  const StopSignals signals;
  CHECK_FALSE(signals.requested());
}
