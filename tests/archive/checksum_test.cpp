#include "trebsweep/archive/checksum.hpp"

#include <cstring>
#include <string_view>
#include <vector>

#include "support/catch.hpp"

using namespace trebsweep;

TEST_CASE("A checksum is XXH3's, 64 bits, with seed 0") {
  const auto of = [](std::string_view text) { return checksum(std::as_bytes(std::span(text))); };
  CHECK(of("") == 0x2d06800538d394c2);
  CHECK(of("a") == 0xe6c632b61e964e1f);
  CHECK(of("abc") == 0x78af5f94892f3950);
}

TEST_CASE("A checksum depends on every bit") {
  std::vector<std::byte> bytes(3000, std::byte{7});  // longer than any block of XXH3
  const std::uint64_t intact = checksum(bytes);
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    bytes[bit / 8] ^= std::byte{1} << (bit % 8);
    REQUIRE(checksum(bytes) != intact);
    bytes[bit / 8] ^= std::byte{1} << (bit % 8);
  }
}
