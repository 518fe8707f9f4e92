#include "trebsweep/swing/integrate_packs.hpp"

namespace trebsweep {

template Work integrate_packs_by<Vern8>(const Scene&, const Solver&, const Batch&);

}  // namespace trebsweep
