#pragma once

#include <algorithm>
#include <array>
#include <string_view>

namespace trebsweep {

/// Names of the steppers that serve packs of designs.
inline constexpr std::array<std::string_view, 6> pack_stepper_names{
    "euler", "modified_midpoint", "rk4", "cash_karp54", "dopri5", "fehlberg78"};

/// Names of the steppers that integrate one design at a time: they keep a history, an order or a
/// matrix.
inline constexpr std::array<std::string_view, 3> single_stepper_names{
    "adams_bashforth_moulton", "bulirsch_stoer", "rosenbrock4"};

/// Names a job can choose a stepper by.
inline constexpr auto stepper_names = [] {
  std::array<std::string_view, pack_stepper_names.size() + single_stepper_names.size()> names;
  std::copy(pack_stepper_names.begin(), pack_stepper_names.end(), names.begin());
  std::copy(single_stepper_names.begin(), single_stepper_names.end(),
            names.begin() + pack_stepper_names.size());
  return names;
}();

inline constexpr bool is_for_packs(std::string_view stepper) {
  return std::find(pack_stepper_names.begin(), pack_stepper_names.end(), stepper) !=
         pack_stepper_names.end();
}

/// Whether the stepper of that name follows a tolerance; the others keep their step.
inline constexpr bool follows_tolerance(std::string_view stepper) {
  constexpr std::array<std::string_view, 5> adaptive{"cash_karp54", "dopri5", "fehlberg78",
                                                     "bulirsch_stoer", "rosenbrock4"};
  return std::find(adaptive.begin(), adaptive.end(), stepper) != adaptive.end();
}

}  // namespace trebsweep
