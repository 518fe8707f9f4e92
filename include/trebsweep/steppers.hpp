#pragma once

#include "trebsweep/adams.hpp"
#include "trebsweep/bulirsch_stoer.hpp"
#include "trebsweep/rosenbrock.hpp"
#include "trebsweep/stepper_names.hpp"

namespace trebsweep {

/// Calls f<Stepper>() with the stepper of that name, one of single_stepper_names.
template <class F>
auto with_single_stepper(std::string_view name, F&& f) {
  if (name == "adams_bashforth_moulton") return f.template operator()<AdamsBashforthMoulton>();
  if (name == "bulirsch_stoer") return f.template operator()<BulirschStoer>();
  if (name == "rosenbrock4") return f.template operator()<Rosenbrock4>();
  throw std::logic_error("no stepper is named " + std::string(name));
}

/// Calls f<Stepper>() with the stepper of that name, one of stepper_names; Stepper<T, E>.
template <class F>
auto with_stepper(std::string_view name, F&& f) {
  return is_for_packs(name) ? with_pack_stepper(name, f) : with_single_stepper(name, f);
}

}  // namespace trebsweep
