#include "trebsweep/swing/flight.hpp"

namespace trebsweep {

template Flight<double> flight(const Scene&, const Vector<double>&, const Vector<double>&);
template ValueAndSlope<double> range_and_slope(const Scene&, const Vector<double>&,
                                               const Vector<double>&, const Vector<double>&,
                                               double);

}  // namespace trebsweep
