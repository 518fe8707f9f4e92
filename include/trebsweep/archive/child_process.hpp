#pragma once

#include <functional>

namespace trebsweep {

/// Calls f in a child process, a copy of this one, and throws away what it does there. Returns
/// whether f ended, by itself or by an exception, rather than by a crash or by having worked for
/// `working` seconds of the processor. Throws std::system_error where there can be no child, and
/// where it had to be ended after `seconds` that it waited most of.
bool completes_in_child(const std::function<void()>& f, unsigned working, unsigned seconds);

}  // namespace trebsweep
