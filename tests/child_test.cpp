#include "trebsweep/child.hpp"

#include <csignal>
#include <cstdlib>
#include <stdexcept>

#include "catch.hpp"

using namespace trebsweep;

TEST_CASE("What ends, even by an exception, survives, and changes nothing here") {
  int calls = 0;
  CHECK(survives([&] { ++calls; }, 10));
  CHECK(survives([] { throw std::runtime_error("no"); }, 10));
  CHECK(calls == 0);
}

TEST_CASE("A crash, an exit and a hang are told") {
  CHECK_FALSE(survives([] { std::abort(); }, 10));
  CHECK_FALSE(survives([] { std::raise(SIGSEGV); }, 10));
  CHECK_FALSE(survives([] { std::_Exit(3); }, 10));
  CHECK_FALSE(survives(
      [] {
        for (volatile bool forever = true; forever;) {
        }
      },
      1));
}
