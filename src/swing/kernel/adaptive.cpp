#include "trebsweep/swing/integrate_packs.hpp"

namespace trebsweep {

template Work integrate_packs_with(const PackStepperFactories<true>&, const Scene&, const Solver&,
                                   const Batch&);

}  // namespace trebsweep
