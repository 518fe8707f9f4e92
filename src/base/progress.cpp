#include "trebsweep/base/progress.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>
#include <string>
#include <utility>

#include "trebsweep/base/message.hpp"

namespace trebsweep {
namespace {

/// Whether stderr reaches a terminal. mpirun forwards it through a pipe, so under mpirun this
/// examines the launcher's stderr instead (on Linux; false elsewhere and on other hosts).
bool reaches_terminal() {
  if (isatty(STDERR_FILENO)) return true;
  if (!std::getenv("OMPI_COMM_WORLD_SIZE") && !std::getenv("PMI_SIZE")) return false;
  const int launcher = open(fmt::format("/proc/{}/fd/2", getppid()).c_str(), O_WRONLY | O_NOCTTY);
  if (launcher < 0) return false;
  const bool terminal = isatty(launcher);
  close(launcher);
  return terminal;
}

std::string clock_text(double seconds) {
  const auto s = static_cast<long long>(seconds + 0.5);
  if (s >= 3600) return fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60);
  return fmt::format("{}:{:02}", s / 60, s % 60);
}

}  // namespace

Progress::Progress(std::uint64_t before, std::uint64_t total, ProgressStyle style, std::string unit)
    : before_(before), total_(total), style_(style), unit_(std::move(unit)) {
  if (style_ == ProgressStyle::automatic)
    style_ = reaches_terminal() ? ProgressStyle::bar : ProgressStyle::lines;
}

void Progress::update(std::uint64_t done) {
  if (style_ == ProgressStyle::none) return;
  const bool bar = style_ == ProgressStyle::bar;
  const bool complete = done >= total_;
  const auto now = Clock::now();
  const auto interval = bar ? std::chrono::milliseconds(100) : std::chrono::seconds(10);
  if (now - last_report_ < interval && !(bar && complete)) return;
  last_report_ = now;

  const double share = static_cast<double>(done) / static_cast<double>(total_);
  const double elapsed = std::chrono::duration<double>(now - start_).count();
  const double rate = static_cast<double>(done - before_) / elapsed;
  std::string time;  // empty as long as there is no rate
  if (complete)
    time = "in " + clock_text(elapsed);
  else if (done > before_)
    time = clock_text(static_cast<double>(total_ - done) / rate) + " left";
  const std::string numbers =
      fmt::format("{:3.0f} %  {} of {} {}  {}", 100 * share, done, total_, unit_, time);
  if (bar) {
    constexpr int width = 30;
    const int filled = static_cast<int>(width * share);
    print_message(fmt::format("\r[{:#<{}}{:.<{}}] {:<60}{}", "", filled, "", width - filled,
                              numbers, complete ? "\n" : ""));
  } else {
    print_message(numbers + "\n");
  }
}

}  // namespace trebsweep
