#include "trebsweep/swing/integrate_packs.hpp"

namespace trebsweep {

template PackSteppers<true> pack_steppers<CashKarp54>();

}  // namespace trebsweep
