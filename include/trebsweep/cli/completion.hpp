#pragma once

#include <string>

namespace trebsweep {

/// The output of `trebsweep completion`: a bash script that completes commands, options, keys and
/// the values of keys that have a few.
std::string bash_completion();

}  // namespace trebsweep
