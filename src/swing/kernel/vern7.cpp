#include "trebsweep/swing/integrate_packs.hpp"

namespace trebsweep {

template PackSteppers<true> pack_steppers<Vern7>();

}  // namespace trebsweep
