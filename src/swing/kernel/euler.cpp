#include "trebsweep/swing/integrate_packs.hpp"

namespace trebsweep {

template PackStepperFactories<false> factories_of<Euler>();

}  // namespace trebsweep
