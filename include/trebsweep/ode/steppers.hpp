#pragma once

#include "trebsweep/ode/adams.hpp"
#include "trebsweep/ode/bulirsch_stoer.hpp"
#include "trebsweep/ode/rosenbrock.hpp"
#include "trebsweep/ode/stepper_info.hpp"

namespace trebsweep {

/// Calls f.operator()<Stepper>() with the class template Stepper<T, E> of that name, which
/// integrates one design at a time. Throws std::logic_error if it is not such a stepper.
template <class F>
auto with_single_stepper(std::string_view name, F&& f) {
  switch (info_of_stepper(name).id) {
    case StepperId::adams_bashforth_moulton:
      return f.template operator()<AdamsBashforthMoulton>();
    case StepperId::bulirsch_stoer:
      return f.template operator()<BulirschStoer>();
    case StepperId::rosenbrock4:
      return f.template operator()<Rosenbrock4>();
    default:
      throw std::logic_error(std::string(name) + " does not integrate one design at a time");
  }
}

}  // namespace trebsweep
