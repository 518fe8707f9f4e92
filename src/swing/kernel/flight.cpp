#include "trebsweep/swing/flight.hpp"

#include "trebsweep/swing/pack_steppers.hpp"

namespace trebsweep {

template Flight<KernelPack> flight(const Scene&, const Vector<KernelPack>&,
                                   const Vector<KernelPack>&);
template ValueAndSlope<KernelPack> range_and_slope(const Scene&, const Vector<KernelPack>&,
                                                   const Vector<KernelPack>&,
                                                   const Vector<KernelPack>&, double);

}  // namespace trebsweep
