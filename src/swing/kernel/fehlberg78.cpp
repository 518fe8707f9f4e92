#include "trebsweep/swing/integrate_packs.hpp"

namespace trebsweep {

template PackSteppers<true> pack_steppers<Fehlberg78>();

}  // namespace trebsweep
