#include "trebsweep/cli/child_process.hpp"

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <stdexcept>
#include <system_error>
#include <thread>

#include "support/catch.hpp"

using namespace trebsweep;

TEST_CASE("A function that returns or throws completes, without effects on this process") {
  int calls = 0;
  CHECK(completes_in_child([&] { ++calls; }, 10, 10));
  CHECK(completes_in_child([] { throw std::runtime_error("no"); }, 10, 10));
  CHECK(calls == 0);
}

TEST_CASE("A crash, an exit and an endless loop do not complete, and an endless wait is an error",
          "[slow]") {
  CHECK_FALSE(completes_in_child([] { std::abort(); }, 10, 10));
  CHECK_FALSE(completes_in_child([] { std::raise(SIGSEGV); }, 10, 10));
  CHECK_FALSE(completes_in_child([] { std::_Exit(3); }, 10, 10));
  const auto loop = [] {
    for (volatile bool forever = true; forever;) {
    }
  };
  CHECK_FALSE(completes_in_child(loop, 1, 10));
  CHECK_THROWS_AS(
      completes_in_child([] { std::this_thread::sleep_for(std::chrono::hours(1)); }, 10, 1),
      std::system_error);
}
