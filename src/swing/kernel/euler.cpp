#include "trebsweep/swing/integrate_packs.hpp"

namespace trebsweep {

template PackSteppers<false> pack_steppers<Euler>();

}  // namespace trebsweep
