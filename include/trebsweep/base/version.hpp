#pragma once

#include <string>

namespace trebsweep {

/// The version of the numerics: raised with every change after which a result may have other bits,
/// so that no unfinished sweep mixes results of both.
inline constexpr int numerics_version = 5;

/// "trebsweep VERSION (REVISION)", where the revision is git's, or "unknown" outside a checkout.
std::string version_text();

}  // namespace trebsweep
