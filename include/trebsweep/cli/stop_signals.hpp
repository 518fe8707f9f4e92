#pragma once

namespace trebsweep {

/// In its scope, SIGINT, SIGTERM and SIGUSR1 ask the program to stop by itself, and a file that
/// grows beyond its limit makes its write fail instead of ending the program. Behind it SIGUSR1 is
/// ignored. At most one at a time.
class StopSignals {
 public:
  StopSignals();
  ~StopSignals();
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;

  /// Whether one of the signals has come.
  bool requested() const;
};

}  // namespace trebsweep
