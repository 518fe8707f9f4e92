#pragma once

namespace trebsweep {

/// While alive, SIGINT, SIGTERM and SIGUSR1 set a flag instead of ending the program, and a write
/// beyond the file size limit fails instead of raising SIGXFSZ. Afterwards SIGUSR1 is ignored and
/// the other signals have their default action. At most one instance may exist at a time.
class StopSignals {
 public:
  StopSignals();
  ~StopSignals();
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;

  /// Whether one of the signals has arrived.
  bool requested() const;
};

}  // namespace trebsweep
