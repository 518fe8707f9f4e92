#pragma once

#include <string>

namespace trebsweep {

/// "trebsweep VERSION (REVISION)", where the revision is git's, or "unknown" outside a checkout.
std::string version_text();

}  // namespace trebsweep
