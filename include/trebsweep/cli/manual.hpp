#pragma once

#include <string>

namespace trebsweep {

/// The manual page trebsweep(1), in the format of man: commands, options, keys and exit codes.
std::string manual_page();

}  // namespace trebsweep
