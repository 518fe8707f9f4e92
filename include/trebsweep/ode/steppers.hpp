#pragma once

#include "trebsweep/ode/adams.hpp"
#include "trebsweep/ode/bulirsch_stoer.hpp"
#include "trebsweep/ode/rosenbrock.hpp"
#include "trebsweep/ode/stepper_info.hpp"

namespace trebsweep {

/// Calls f.operator()<Stepper>() with the class template Stepper<T, E> of that name. Throws
/// std::logic_error if it is unknown.
template <class F>
auto with_stepper(std::string_view name, F&& f) {
  switch (info_of_stepper(name).id) {
    case StepperId::adams_bashforth_moulton:
      return f.template operator()<AdamsBashforthMoulton>();
    case StepperId::bulirsch_stoer:
      return f.template operator()<BulirschStoer>();
    case StepperId::rosenbrock4:
      return f.template operator()<Rosenbrock4>();
    default:
      return with_pack_stepper(name, f);
  }
}

}  // namespace trebsweep
