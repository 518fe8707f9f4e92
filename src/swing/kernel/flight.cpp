#include "trebsweep/swing/flight.hpp"

namespace trebsweep {

template Flight<Pack<2>> flight(const Scene&, const Vector<Pack<2>>&, const Vector<Pack<2>>&);
template ValueAndSlope<Pack<2>> range_and_slope(const Scene&, const Vector<Pack<2>>&,
                                                const Vector<Pack<2>>&, const Vector<Pack<2>>&,
                                                double);
template Flight<Pack<3>> flight(const Scene&, const Vector<Pack<3>>&, const Vector<Pack<3>>&);
template ValueAndSlope<Pack<3>> range_and_slope(const Scene&, const Vector<Pack<3>>&,
                                                const Vector<Pack<3>>&, const Vector<Pack<3>>&,
                                                double);

}  // namespace trebsweep
