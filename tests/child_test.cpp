#include "trebsweep/child.hpp"

#include <csignal>
#include <cstdlib>
#include <stdexcept>
#include <system_error>

#include "catch.hpp"

using namespace trebsweep;

TEST_CASE("What ends, even by an exception, survives, and changes nothing here") {
  int calls = 0;
  CHECK(survives([&] { ++calls; }, 10));
  CHECK(survives([] { throw std::runtime_error("no"); }, 10));
  CHECK(calls == 0);
}

TEST_CASE("A crash and an exit do not survive, and a hang is an error") {
  CHECK_FALSE(survives([] { std::abort(); }, 10));
  CHECK_FALSE(survives([] { std::raise(SIGSEGV); }, 10));
  CHECK_FALSE(survives([] { std::_Exit(3); }, 10));
  const auto hang = [] {
    for (volatile bool forever = true; forever;) {
    }
  };
  CHECK_THROWS_AS(survives(hang, 1), std::system_error);
}
