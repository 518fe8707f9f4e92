#pragma once

#include <functional>

namespace trebsweep {

/// Calls f in a child process, a copy of this one, and throws away what it does there. Returns
/// whether f ended, by itself or by an exception, rather than by a crash or, after `seconds`, not
/// at all. Throws std::system_error where there can be no child.
bool survives(const std::function<void()>& f, unsigned seconds);

}  // namespace trebsweep
