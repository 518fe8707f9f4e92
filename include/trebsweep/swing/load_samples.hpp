#pragma once

#include <array>
#include <cstddef>
#include <type_traits>

#include "trebsweep/model/mechanism.hpp"
#include "trebsweep/ode/any_stepper.hpp"
#include "trebsweep/ode/interpolation.hpp"

namespace trebsweep {

/// Nodes within a step: those of Gauss-Lobatto quadrature with six nodes, which keep the error of
/// the interpolating polynomial small.
inline constexpr std::array<double, 6> load_nodes{
    0, 0.11747233803526763, 0.3573842417596774, 0.6426157582403226, 0.8825276619647324, 1};

template <class T>
using LoadSamples = std::array<Loads<T>, load_nodes.size()>;

/// The loads at an instant.
template <class T, Effects E>
Loads<T> loads_at(const Motion<T, E>& motion, const Mechanism<T, E>& mechanism,
                  const Instant<T, E>& at) {
  return mechanism.loads(at.x, at.directions, at.dxdt, motion.normal_force(at.x, at.directions));
}

/// The loads at the nodes of a step of length h, for the interpolated motion.
template <class T, Effects E>
[[gnu::noinline]] LoadSamples<T> interpolated_loads(const Motion<T, E>& motion,
                                                    const Mechanism<T, E>& mechanism,
                                                    const Instant<T, E>& from,
                                                    const Instant<T, E>& to, const T& h) {
  const Quintic<T, E> between(from, to, h);
  LoadSamples<T> loads;
  for (std::size_t i = 1; i + 1 < load_nodes.size(); ++i) {
    const Instant<T, E> at = instant(motion, T(0), between(load_nodes[i]));
    loads[i] = loads_at(motion, mechanism, at);
  }
  loads.front() = loads_at(motion, mechanism, from);
  loads.back() = loads_at(motion, mechanism, to);
  return loads;
}

/// The same, where the stepper itself integrates to the nodes.
template <class T, Effects E>
LoadSamples<T> integrated_loads(const AnyStepper<T, E>& stepper, const Motion<T, E>& motion,
                                const Mechanism<T, E>& mechanism, const Instant<T, E>& from,
                                const Instant<T, E>& to, const T& h) {
  LoadSamples<T> loads;
  for (std::size_t i = 1; i + 1 < load_nodes.size(); ++i) {
    Instant<T, E> at;
    State<T, E> error;
    advance(stepper, motion, from, T(T(load_nodes[i]) * h), at, error);
    loads[i] = loads_at(motion, mechanism, at);
  }
  loads.front() = loads_at(motion, mechanism, from);
  loads.back() = loads_at(motion, mechanism, to);
  return loads;
}

}  // namespace trebsweep
