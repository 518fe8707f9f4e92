#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>

namespace trebsweep {

/// The steppers a job can choose.
enum class StepperId {
  euler,
  modified_midpoint,
  rk4,
  cash_karp54,
  dopri5,
  fehlberg78,
  vern7,
  vern8,
  adams_bashforth_moulton,
  bulirsch_stoer,
  rosenbrock4
};

/// Properties of a stepper that are known without its C++ type.
struct StepperInfo {
  StepperId id;
  std::string_view name;  ///< in job files
  int order;              ///< of convergence with steps of one length; 0: variable
  unsigned stages;  ///< evaluations of the right-hand side per step; 0: it depends on the step
  bool follows_tolerance;  ///< otherwise its steps have a fixed length
  bool for_packs;          ///< integrates one design per SIMD lane; otherwise one design at a time
  bool has_stability_function;  ///< each step is the same function of the state and the step length
};

/// The registry of steppers, in the order of StepperId. Help, job files, dispatch, assess and the
/// stability analysis take their lists from it.
inline constexpr std::array<StepperInfo, 11> stepper_info{{
    {StepperId::euler, "euler", 1, 1, false, true, true},
    {StepperId::modified_midpoint, "modified_midpoint", 2, 3, false, true, true},
    {StepperId::rk4, "rk4", 4, 4, false, true, true},
    {StepperId::cash_karp54, "cash_karp54", 5, 6, true, true, true},
    {StepperId::dopri5, "dopri5", 5, 6, true, true, true},
    {StepperId::fehlberg78, "fehlberg78", 8, 13, true, true, true},
    {StepperId::vern7, "vern7", 7, 10, true, true, true},
    {StepperId::vern8, "vern8", 8, 13, true, true, true},
    {StepperId::adams_bashforth_moulton, "adams_bashforth_moulton", 5, 0, false, false, false},
    {StepperId::bulirsch_stoer, "bulirsch_stoer", 0, 0, true, false, false},
    {StepperId::rosenbrock4, "rosenbrock4", 4, 0, true, false, true},
}};

static_assert(std::all_of(stepper_info.begin(), stepper_info.end(), [](const StepperInfo& stepper) {
  return &stepper - stepper_info.data() == static_cast<std::ptrdiff_t>(stepper.id);
}));

/// Names a job can choose a stepper by, in the order of StepperId.
inline constexpr auto stepper_names = [] {
  std::array<std::string_view, stepper_info.size()> names;
  std::transform(stepper_info.begin(), stepper_info.end(), names.begin(),
                 [](const StepperInfo& stepper) { return stepper.name; });
  return names;
}();

/// The stepper of that name. Throws std::logic_error if it is unknown.
constexpr const StepperInfo& info_of_stepper(std::string_view name) {
  const auto found = std::find(stepper_names.begin(), stepper_names.end(), name);
  if (found == stepper_names.end())
    throw std::logic_error("no stepper is named " + std::string(name));
  return stepper_info[static_cast<std::size_t>(found - stepper_names.begin())];
}

inline bool is_for_packs(std::string_view stepper) { return info_of_stepper(stepper).for_packs; }

inline bool follows_tolerance(std::string_view stepper) {
  return info_of_stepper(stepper).follows_tolerance;
}

}  // namespace trebsweep
