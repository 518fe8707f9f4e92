#pragma once

#include <stdexcept>
#include <string>

namespace trebsweep {

/// An error in the user's input: the command line, the job file or the output path. The program
/// exits with code 2.
struct InputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Rejects the value of a key. Throws InputError: "key = value: must be allowed".
[[noreturn]] void refuse(const std::string& key, const std::string& value,
                         const std::string& allowed);

/// A user's text for a message, truncated to 200 characters.
std::string shortened(const std::string& text);

/// The text with control characters, which a terminal would interpret, replaced by '?'.
std::string printable(std::string text);

}  // namespace trebsweep
