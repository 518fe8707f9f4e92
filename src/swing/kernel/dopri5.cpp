#include "trebsweep/swing/integrate_packs.hpp"

namespace trebsweep {

template PackStepperFactories<true> factories_of<Dopri5>();

}  // namespace trebsweep
