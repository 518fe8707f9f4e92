#include "trebsweep/archive/journal.hpp"

#include <algorithm>
#include <numeric>
#include <string>

#include "support/catch.hpp"
#include "support/temporary_directory.hpp"

using namespace trebsweep;
namespace fs = std::filesystem;

namespace {

/// The results of record n: n bytes.
std::vector<std::byte> results_of(std::uint64_t n) {
  std::vector<std::byte> bytes(n);
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::byte>(n + i);
  return bytes;
}

constexpr std::uint64_t records = 20, sweep = 7;

/// A journal with records 0 to 19.
std::vector<std::byte> some_journal(const fs::path& path) {
  Journal journal(path, sweep);
  for (std::uint64_t n = 0; n < records; ++n) {
    journal.append(n, results_of(n));
    if (n == 5) journal.write();
  }
  CHECK(journal.unwritten_bytes() > 0);
  journal.sync();
  CHECK(journal.unwritten_bytes() == 0);
  const std::string text = read_file(path);
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

/// The numbers of the records, which must be intact.
std::vector<std::uint64_t> numbers_of(const std::vector<Record>& found) {
  std::vector<std::uint64_t> numbers;
  for (const auto& [number, results] : found) {
    CHECK(std::ranges::equal(results, results_of(number)));
    numbers.push_back(number);
  }
  return numbers;
}

std::vector<std::uint64_t> all_but(std::uint64_t missing) {
  std::vector<std::uint64_t> numbers(records);
  std::iota(numbers.begin(), numbers.end(), std::uint64_t{0});
  std::erase(numbers, missing);
  return numbers;
}

}  // namespace

TEST_CASE("The records of a journal are those that were appended, written or not") {
  const TemporaryDirectory directory;
  const fs::path file = directory / "a.journal";
  Journal journal(file, sweep);
  CHECK(journal.records().empty());
  journal.append(0, results_of(0));
  CHECK_FALSE(fs::exists(file));
  journal.append(4, results_of(4));
  CHECK(numbers_of(journal.records()) == std::vector<std::uint64_t>{0, 4});
  journal.write();
  journal.append(2, results_of(2));
  CHECK(numbers_of(journal.records()) == std::vector<std::uint64_t>{0, 4, 2});
  CHECK(numbers_of(intact_records(bytes_of(map_file(file)), sweep)) ==
        std::vector<std::uint64_t>{0, 4});
}

TEST_CASE("A journal that ends within its last record has all others") {
  const TemporaryDirectory directory;
  const fs::path file = directory / "cut.journal";
  const auto journal = some_journal(file);
  const std::size_t last = record_header_bytes + records - 1;
  for (std::size_t cut = 1; cut <= last; ++cut)
    CHECK(numbers_of(intact_records(std::span(journal).first(journal.size() - cut), sweep)) ==
          all_but(records - 1));
  CHECK(intact_records({}, sweep).empty());
}

TEST_CASE("A record in which any bit is flipped is missing, and no other") {
  const TemporaryDirectory directory;
  const fs::path file = directory / "flipped.journal";
  auto journal = some_journal(file);
  std::size_t end = 0;
  for (std::uint64_t n = 0; n < records; ++n) {
    const std::size_t begin = end;
    end = begin + record_header_bytes + n;
    for (std::size_t bit = 8 * begin; bit < 8 * end; ++bit) {
      const std::byte flip{static_cast<unsigned char>(1 << bit % 8)};
      journal[bit / 8] ^= flip;
      const auto found = numbers_of(intact_records(journal, sweep));
      if (found != all_but(n)) FAIL("bit " << bit);
      journal[bit / 8] ^= flip;
    }
  }
  CHECK(numbers_of(intact_records(journal, sweep)) == all_but(records));
}

TEST_CASE("A journal has no records of another sweep") {
  const TemporaryDirectory directory;
  const auto journal = some_journal(directory / "a.journal");
  CHECK(intact_records(journal, sweep).size() == records);
  CHECK(intact_records(journal, sweep + 1).empty());
}

TEST_CASE("A journal never replaces a file") {
  const TemporaryDirectory directory;
  const fs::path file = directory / "existing.journal";
  write_file(file, "precious");
  Journal journal(file, sweep);
  journal.append(1, results_of(1));
  CHECK_THROWS_WITH(journal.write(), contains("cannot create") && contains("existing.journal"));
  CHECK(read_file(file) == "precious");
  Journal nowhere("/nowhere/a.journal", sweep);
  nowhere.append(1, results_of(1));
  CHECK_THROWS_WITH(nowhere.write(), contains("No such file"));
}

TEST_CASE("A file that is missing cannot be read, and an empty one has no records") {
  const TemporaryDirectory directory;
  const fs::path file = directory / "missing.journal";
  CHECK_THROWS_WITH(map_file(file), contains("cannot read") && contains("missing.journal"));
  write_file(file, "");
  CHECK(intact_records(bytes_of(map_file(file)), sweep).empty());
}
