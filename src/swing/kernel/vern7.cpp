#include "trebsweep/swing/integrate_packs.hpp"

namespace trebsweep {

template PackStepperFactories<true> factories_of<Vern7>();

}  // namespace trebsweep
