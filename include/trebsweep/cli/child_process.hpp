#pragma once

#include <functional>

namespace trebsweep {

/// Calls f in a forked child process, whose effects on memory and whose stderr are discarded.
/// Returns true if f returns or throws, and false if it crashes, exits, or uses more than
/// `cpu_seconds` of processor time. Throws std::system_error if fork() fails, or if f is still
/// waiting after `wall_seconds`. Not for a process that has started MPI.
bool completes_in_child(const std::function<void()>& f, unsigned cpu_seconds,
                        unsigned wall_seconds);

}  // namespace trebsweep
