#include "trebsweep/job/config_file.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <boost/algorithm/string/trim.hpp>
#include <boost/program_options.hpp>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <utility>

#include "trebsweep/base/error.hpp"

namespace trebsweep {
namespace {

namespace po = boost::program_options;

/// A line of a job file without its comment.
struct Line {
  std::string text;
  bool hash_in_value;  ///< a # follows the value without a space between them
};

Line without_comment(const std::string& line) {
  const auto hash = line.find('#');
  Line result{boost::trim_copy(line.substr(0, hash)), false};
  result.hash_in_value = hash != line.npos && !result.text.empty() &&
                         !std::isspace(static_cast<unsigned char>(line[hash - 1]));
  return result;
}

/// Throws InputError for lines that Boost would misread or accept. Boost's own messages lack line
/// numbers, and its formatting of a message about a malformed line never terminates if the line
/// contains one of the placeholders, such as %invalid_line%.
void check_lines(const std::string& text, const std::string& name) {
  const auto refuse_line = [&](int number, const std::string& line, const std::string& why) {
    throw InputError(fmt::format("job file {}: line {}, '{}', {}", shortened(name), number,
                                 shortened(line), why));
  };
  std::map<std::string, int> lines;
  std::istringstream stream(text);
  std::string line, section;
  for (int number = 1; std::getline(stream, line); ++number) {
    const auto [content, hash_in_value] = without_comment(line);
    if (content.empty()) continue;
    const auto equals = content.find('=');
    if (content.size() > 2 && content.starts_with('[') && content.ends_with(']')) {
      section = content.substr(1, content.size() - 2);
      if (!section.ends_with('.')) section += '.';  // as Boost does
    } else if (equals == content.npos) {
      refuse_line(number, content, "is neither [section] nor key = value");
    } else if (hash_in_value) {
      refuse_line(number, boost::trim_copy(line),
                  "has a # inside a value; put a space before a comment");
    } else {
      const std::string key = section + boost::trim_copy(content.substr(0, equals));
      const auto [first, is_new] = lines.emplace(key, number);
      if (!is_new)
        throw InputError(fmt::format("job file {}: {} is given twice, on lines {} and {}",
                                     shortened(name), shortened(key), first->second, number));
    }
  }
}

bool is_binary(const std::string& text) {
  return std::any_of(text.begin(), text.end(), [](unsigned char c) {
    return c < ' ' && c != '\n' && c != '\r' && c != '\t';
  });
}

constexpr std::size_t max_size = 1 << 20;  // of a job file

[[noreturn]] void refuse_file(const std::string& name, const std::string& why) {
  throw InputError(fmt::format("{}: {}; give the path of a readable text file", name, why));
}

/// The content of a job file, without a byte-order mark. Throws InputError if it is not text, or
/// too long.
std::string checked_text(std::string content, const std::string& name) {
  if (content.starts_with("\xef\xbb\xbf")) content.erase(0, 3);
  if (is_binary(content)) refuse_file(name, "is not a text file");
  if (content.size() > max_size) refuse_file(name, "is longer than 1 MiB");
  return content;
}

}  // namespace

std::map<std::string, std::string> parse_config(const std::string& text, const std::string& name) {
  check_lines(text, name);
  std::map<std::string, std::string> values;
  try {
    std::istringstream stream(text);
    const bool allow_unregistered = true;
    const auto parsed =
        po::parse_config_file(stream, po::options_description(), allow_unregistered);
    for (const auto& option : parsed.options) values[option.string_key] = option.value.at(0);
  } catch (const po::error& error) {
    throw InputError(fmt::format("job file {}: {}", name, error.what()));
  }
  return values;
}

std::string read_job_file(const std::string& path, const std::string& what) {
  const std::string name = what + shortened(path);
  namespace fs = std::filesystem;
  std::error_code unknown;  // opening the file reports the reason
  if (fs::is_directory(path, unknown)) refuse_file(name, "is a directory");
  // Reading a FIFO or a device could block forever.
  if (fs::exists(path, unknown) && !fs::is_regular_file(path, unknown))
    refuse_file(name, "is not a regular file");
  std::ifstream file(path, std::ios::binary);
  if (!file) refuse_file(name, std::strerror(errno));
  std::string content(max_size + 1, '\0');
  file.read(content.data(), static_cast<std::streamsize>(content.size()));
  if (file.bad()) refuse_file(name, std::strerror(errno));
  content.resize(static_cast<std::size_t>(file.gcount()));
  return checked_text(std::move(content), name);
}

std::string read_job_from_stdin() {
  const std::string name = "job file - (stdin)";
  std::string content(max_size + 1, '\0');
  std::size_t size = 0;
  while (size < content.size()) {
    // A sweep's signals interrupt poll, but not read: Ctrl-C must end a wait for the terminal.
    pollfd input{STDIN_FILENO, POLLIN, 0};
    const auto count =
        poll(&input, 1, -1) < 0 ? -1 : read(STDIN_FILENO, &content[size], content.size() - size);
    if (count < 0) refuse_file(name, std::strerror(errno));
    if (count == 0) break;
    size += static_cast<std::size_t>(count);
  }
  if (size == 0) refuse_file(name, "is empty");
  content.resize(size);
  return checked_text(std::move(content), name);
}

}  // namespace trebsweep
