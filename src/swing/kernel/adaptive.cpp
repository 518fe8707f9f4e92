#include "trebsweep/swing/integrate_packs.hpp"

namespace trebsweep {

template Work integrate_packs_with(const PackSteppers<true>&, const Scene&, const Solver&,
                                   const Batch&, ObservedSwing*);

}  // namespace trebsweep
