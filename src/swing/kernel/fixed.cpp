#include "trebsweep/swing/integrate_packs.hpp"

namespace trebsweep {

template Work integrate_packs_with(const PackStepperFactories<false>&, const Scene&, const Solver&,
                                   const Batch&);

}  // namespace trebsweep
