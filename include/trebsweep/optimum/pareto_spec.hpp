#pragma once

#include <cstddef>
#include <string>

namespace trebsweep {

/// Two objectives of which more of one costs some of the other.
struct ParetoSpec {
  std::string first, second;  ///< expressions as of optimum.objective
  std::size_t points;         ///< at least 3
};

}  // namespace trebsweep
