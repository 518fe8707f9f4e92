#pragma once

#include <array>
#include <string_view>

namespace trebsweep {

/// An exit code of the program, as help and manual explain it.
struct ExitCode {
  int code;
  std::string_view meaning;
};

namespace exit_code {

inline constexpr ExitCode complete{0, "complete, or complete already"};
inline constexpr ExitCode failed{1, "run-time error"};
inline constexpr ExitCode refused{
    2, "invalid command line, job file or output path, or too little space; nothing was written"};
inline constexpr ExitCode nothing_found{3, "nothing found: no design is an optimum"};
inline constexpr ExitCode stopped{
    75,
    "stopped by a signal or --time-limit; run the same command again to continue"};  // EX_TEMPFAIL

/// All of them.
inline constexpr std::array all{complete, failed, refused, nothing_found, stopped};

}  // namespace exit_code

}  // namespace trebsweep
