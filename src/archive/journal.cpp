#include "trebsweep/archive/journal.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <type_traits>

#include "trebsweep/archive/checksum.hpp"
#include "trebsweep/archive/free_space.hpp"

namespace trebsweep {
namespace {

constexpr std::array<char, 8> mark{'t', 'r', 'e', 'b', 'r', 'e', 'c', '\n'};

struct Header {
  std::array<char, 8> mark;
  std::uint32_t kind;
  std::uint32_t unused;
  std::uint64_t number;
  std::uint64_t size;  ///< of the results, bytes
  std::uint64_t checksum;
};
static_assert(sizeof(Header) == 40 && std::is_trivially_copyable_v<Header>);

/// The checksum of a record: of its header without the checksum, and of its results.
std::uint64_t record_checksum(const Header& header, std::span<const std::byte> results) {
  const auto head = std::as_bytes(std::span(&header, 1)).first(offsetof(Header, checksum));
  return checksum(results, checksum(head));
}

/// The record at the start of some bytes, if it is intact.
std::optional<Record> first_record(std::span<const std::byte> bytes) {
  Header header;
  if (bytes.size() < sizeof header) return std::nullopt;
  std::memcpy(&header, bytes.data(), sizeof header);
  bytes = bytes.subspan(sizeof header);
  if (header.mark != mark || header.size > bytes.size() || header.kind > 1) return std::nullopt;
  const auto results = bytes.first(header.size);
  if (header.checksum != record_checksum(header, results)) return std::nullopt;
  return Record{static_cast<RecordKind>(header.kind), header.number, results};
}

[[noreturn]] void fail(const std::string& what, const std::filesystem::path& path,
                       const std::string& rest = "") {
  throw std::runtime_error(
      fmt::format("cannot {} {}: {}{}", what, path.string(), std::strerror(errno), rest));
}

}  // namespace

std::vector<Record> intact_records(std::span<const std::byte> journal) {
  std::vector<Record> records;
  while (!journal.empty()) {
    if (const auto record = first_record(journal)) {
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

MappedFile::MappedFile(const std::filesystem::path& path) {
  namespace ipc = boost::interprocess;
  try {
    // Empty files cannot be mapped.
    if (std::filesystem::file_size(path) > 0)
      region_ = ipc::mapped_region(ipc::file_mapping(path.c_str(), ipc::read_only), ipc::read_only);
  } catch (const std::exception& error) {
    throw std::runtime_error(fmt::format("cannot read {}: {}", path.string(), error.what()));
  }
}

std::span<const std::byte> MappedFile::bytes() const {
  return {static_cast<const std::byte*>(region_.get_address()), region_.get_size()};
}

Journal::~Journal() {
  if (file_ >= 0) close(file_);
}

void Journal::append(const Record& record) {
  Header header{
      mark, static_cast<std::uint32_t>(record.kind), 0, record.number, record.results.size(), 0};
  header.checksum = record_checksum(header, record.results);
  const auto head = std::as_bytes(std::span(&header, 1));
  unwritten_.insert(unwritten_.end(), head.begin(), head.end());
  unwritten_.insert(unwritten_.end(), record.results.begin(), record.results.end());
}

void Journal::write() {
  if (unwritten_.empty()) return;
  if (file_ < 0) {
    file_ = open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (file_ < 0) fail("create", path_);
  }
  for (std::span<const std::byte> rest(unwritten_); !rest.empty();) {
    const auto written = ::write(file_, rest.data(), rest.size());
    if (written > 0)
      rest = rest.subspan(static_cast<std::size_t>(written));
    else if (written == 0 || errno != EINTR)
      fail("write", path_,
           reached_limit(path_) +
               "; the finished tiles are kept, and the same command will continue the sweep");
  }
  unwritten_.clear();
}

void Journal::sync() {
  write();
  if (file_ >= 0 && fsync(file_) != 0) fail("sync", path_);
}

std::vector<Record> Journal::records() {
  written_.clear();
  if (file_ >= 0) written_.emplace_back(path_);
  std::vector<Record> all;
  for (const MappedFile& file : written_) all = intact_records(file.bytes());
  const auto unwritten = intact_records(unwritten_);
  all.insert(all.end(), unwritten.begin(), unwritten.end());
  return all;
}

}  // namespace trebsweep
