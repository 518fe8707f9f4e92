#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace trebsweep {

/// How a command reports its progress on stderr.
enum class ProgressStyle {
  automatic,  ///< a bar if stderr is a terminal, else lines
  bar,        ///< one line, redrawn
  lines,      ///< a line every ten seconds
  none
};

/// Progress on stderr, with an estimate of the remaining time from the mean rate so far.
class Progress {
 public:
  /// `before` of the `total` were done by earlier runs; `unit` names what is counted.
  Progress(std::uint64_t before, std::uint64_t total, ProgressStyle style,
           std::string unit = "designs");

  /// Reports that `done` of the total are done. Rate-limited, except that a bar's end is always
  /// drawn.
  void update(std::uint64_t done);

 private:
  using Clock = std::chrono::steady_clock;

  std::uint64_t before_, total_;
  ProgressStyle style_;
  std::string unit_;
  Clock::time_point start_ = Clock::now();
  Clock::time_point last_report_ = start_;
};

}  // namespace trebsweep
