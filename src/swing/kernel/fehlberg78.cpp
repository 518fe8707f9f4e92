#include "trebsweep/swing/integrate_packs.hpp"

namespace trebsweep {

template PackStepperFactories<true> factories_of<Fehlberg78>();

}  // namespace trebsweep
