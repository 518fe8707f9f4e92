#pragma once

#include <string>
#include <system_error>

namespace trebsweep {

/// stdout cannot be written.
struct OutputError : std::system_error {
  using std::system_error::system_error;
};

/// Prints a text on stderr. A failure is ignored: no result or exit code depends on whether
/// messages can be read.
void print_message(const std::string& text);

/// Prints a text on stdout. Throws OutputError.
void print_result(const std::string& text);

}  // namespace trebsweep
