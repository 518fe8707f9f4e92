#include "trebsweep/archive/journal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <boost/interprocess/file_mapping.hpp>
#include <cerrno>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <type_traits>

#include "trebsweep/archive/checksum.hpp"
#include "trebsweep/archive/free_space.hpp"
#include "trebsweep/archive/regular_file.hpp"

namespace trebsweep {
namespace {

/// It changes with the form of the results.
constexpr std::array<char, 8> mark{'t', 'r', 'e', 'b', 'r', 'e', 'c', '3'};

struct Header {
  std::array<char, 8> mark;
  std::uint64_t number;
  std::uint64_t size;  ///< of the results, bytes
  std::uint64_t checksum;
};
static_assert(sizeof(Header) == record_header_bytes && std::is_trivially_copyable_v<Header>);

/// The checksum of a record of a sweep: of its header without the checksum, and of its results.
std::uint64_t record_checksum(const Header& header, std::span<const std::byte> results,
                              std::uint64_t sweep) {
  const auto head = std::as_bytes(std::span(&header, 1)).first(offsetof(Header, checksum));
  return checksum(results, checksum(head, sweep));
}

/// The record at the start of some bytes, if it is intact.
std::optional<Record> first_record(std::span<const std::byte> bytes, std::uint64_t sweep) {
  Header header;
  if (bytes.size() < sizeof header) return std::nullopt;
  std::memcpy(&header, bytes.data(), sizeof header);
  bytes = bytes.subspan(sizeof header);
  if (header.mark != mark || header.size > bytes.size()) return std::nullopt;
  const auto results = bytes.first(header.size);
  if (header.checksum != record_checksum(header, results, sweep)) return std::nullopt;
  return Record{header.number, results};
}

}  // namespace

std::vector<Record> intact_records(std::span<const std::byte> journal, std::uint64_t sweep) {
  std::vector<Record> records;
  while (!journal.empty()) {
    if (const auto record = first_record(journal, sweep)) {
      records.push_back(*record);
      journal = journal.subspan(sizeof(Header) + record->results.size());
    } else {
      const auto is_mark = [](std::byte b, char c) { return b == static_cast<std::byte>(c); };
      const auto next =
          std::search(journal.begin() + 1, journal.end(), mark.begin(), mark.end(), is_mark);
      journal = journal.subspan(static_cast<std::size_t>(next - journal.begin()));
    }
  }
  return records;
}

MappedFile map_file(const std::filesystem::path& path) {
  namespace ipc = boost::interprocess;
  try {
    if (std::filesystem::file_size(path) == 0) return {};  // cannot be mapped
    return {ipc::file_mapping(path.c_str(), ipc::read_only), ipc::read_only};
  } catch (const std::exception& error) {
    throw std::runtime_error(fmt::format("cannot read {}: {}", path.string(), error.what()));
  }
}

std::span<const std::byte> bytes_of(const MappedFile& file) {
  return {static_cast<const std::byte*>(file.get_address()), file.get_size()};
}

void Journal::append(std::uint64_t number, std::vector<std::byte> results) {
  unwritten_bytes_ += record_header_bytes + results.size();
  unwritten_.push_back({number, std::move(results)});
}

void Journal::write() {
  if (unwritten_.empty()) return;
  if (!file_.is_open() && std::filesystem::exists(path_))
    throw std::runtime_error(fmt::format("cannot create {}: it exists", path_.string()));
  errno = 0;
  if (!file_.is_open()) file_.open(path_, std::ios::binary);
  const auto put = [&](std::span<const std::byte> bytes) {
    file_.write(reinterpret_cast<const char*>(bytes.data()),
                static_cast<std::streamsize>(bytes.size()));
  };
  for (const auto& [number, results] : unwritten_) {
    Header header{mark, number, results.size(), 0};
    header.checksum = record_checksum(header, results, sweep_);
    put(std::as_bytes(std::span(&header, 1)));
    put(results);
  }
  if (!file_.flush())
    throw std::runtime_error(
        fmt::format("cannot write {}: {}{}; the finished tiles are kept, and the same command will "
                    "continue the sweep",
                    path_.string(), std::strerror(errno), reached_limit(path_)));
  unwritten_.clear();
  unwritten_bytes_ = 0;
}

void Journal::sync() {
  write();
  if (file_.is_open()) sync_file(path_);
}

std::vector<Record> Journal::records() {
  if (file_.is_open()) written_ = map_file(path_);
  auto all = intact_records(bytes_of(written_), sweep_);
  for (const auto& [number, results] : unwritten_) all.push_back({number, results});
  return all;
}

}  // namespace trebsweep
