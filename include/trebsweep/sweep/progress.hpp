#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace trebsweep {

/// How a sweep tells of its progress on stderr.
enum class ProgressStyle {
  automatic,  ///< a bar where stderr is a terminal, else lines
  bar,        ///< one line, redrawn
  lines,      ///< a line every ten seconds
  none
};

/// Progress on stderr, with the time that is left at the pace so far.
class Progress {
 public:
  /// `before`: of the total, done before it begins; `unit`: what is counted.
  Progress(std::uint64_t before, std::uint64_t total, ProgressStyle style,
           std::string unit = "designs");

  /// Tells that `done` of the total are done; rate-limited, but the end of a bar is always drawn.
  void update(std::uint64_t done);

 private:
  using Clock = std::chrono::steady_clock;

  std::uint64_t before_, total_;
  ProgressStyle style_;
  std::string unit_;
  Clock::time_point start_ = Clock::now();
  Clock::time_point told_ = start_;
};

}  // namespace trebsweep
