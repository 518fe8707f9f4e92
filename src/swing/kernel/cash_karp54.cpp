#include "trebsweep/swing/integrate_packs.hpp"

namespace trebsweep {

template PackStepperFactories<true> factories_of<CashKarp54>();

}  // namespace trebsweep
