#include "trebsweep/stop_signals.hpp"

#include <signal.h>

#include "catch.hpp"

using namespace trebsweep;

TEST_CASE("Each of the signals asks to stop, and is forgotten afterwards") {
  for (const int number : {SIGINT, SIGTERM, SIGUSR1}) {
    const StopSignals signals;
    CHECK_FALSE(signals.came());
    raise(number);
    CHECK(signals.came());
    raise(number);
    CHECK(signals.came());
  }
  const StopSignals signals;
  CHECK_FALSE(signals.came());
}
