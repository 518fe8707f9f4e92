#pragma once

#include <stdexcept>

namespace trebsweep {

/// The user can mend it: a bad command line, job file or output path. The program ends with exit
/// code 2.
struct InputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace trebsweep
