#pragma once

#include <functional>

namespace trebsweep {

/// Called with the fraction of some work that is done, in [0, 1]; returns whether to stop.
using ProgressCallback = std::function<bool(double fraction)>;

}  // namespace trebsweep
