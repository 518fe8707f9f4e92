#include "trebsweep/optimum/field_values.hpp"

#include <algorithm>
#include <iterator>
#include <limits>
#include <vector>

#include "trebsweep/swing/integrate.hpp"

namespace trebsweep {

Solver coarse_solver(const Solver& solver) { return solver_of("vern8", 1e-6, solver); }

Eigen::MatrixXd field_values(const Scene& scene, const Solver& solver, Accuracy accuracy,
                             std::span<const Design<double>> designs,
                             std::span<const Field> fields) {
  std::vector<Field> computed;  // those that are not in every SwingResult
  for (const Field field : fields)
    if (!is_basic(field) && std::ranges::count(computed, field) == 0) computed.push_back(field);
  std::vector<SwingResult> swings(designs.size());
  std::vector<double> values(designs.size() * computed.size());
  const Batch batch{designs, swings, computed, values};
  if (accuracy == Accuracy::coarse)
    integrate(scene, coarse_solver(solver), batch);
  else  // by vern8, unless that is the stepper to be checked
    integrate_accurately(
        scene, solver_of(accuracy == Accuracy::check ? "vern8" : "dopri5", 1e-13, solver), batch);

  Eigen::MatrixXd result(static_cast<Eigen::Index>(fields.size()),
                         static_cast<Eigen::Index>(designs.size()));
  for (std::size_t n = 0; n < designs.size(); ++n)
    for (std::size_t f = 0; f < fields.size(); ++f) {
      double value = fields[f] == Field::speed ? swings[n].speed : swings[n].release_time;
      if (const auto at = std::ranges::find(computed, fields[f]); at != computed.end())
        value = values[n * computed.size() + static_cast<std::size_t>(at - computed.begin())];
      if (!has_speed(swings[n].status)) value = std::numeric_limits<double>::quiet_NaN();
      result(static_cast<Eigen::Index>(f), static_cast<Eigen::Index>(n)) = value;
    }
  return result;
}

}  // namespace trebsweep
