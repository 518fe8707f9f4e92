#include "trebsweep/optimum/field_values.hpp"

#include <vector>

#include "trebsweep/swing/integrate.hpp"

namespace trebsweep {

Solver coarse_solver(const Solver& solver) { return solver_of("vern8", 1e-6, solver); }

Eigen::MatrixXd field_values(const Scene& scene, const Solver& solver, Accuracy accuracy,
                             std::span<const Design<double>> designs,
                             std::span<const Field> fields) {
  Eigen::MatrixXd values(static_cast<Eigen::Index>(fields.size()),
                         static_cast<Eigen::Index>(designs.size()));
  std::vector<SwingResult> swings(designs.size());
  const Batch batch{designs, swings, fields, {values.data(), fields.size() * designs.size()}};
  const Solver coarse = coarse_solver(solver);  // of vern8
  if (accuracy == Accuracy::coarse)
    integrate(scene, coarse, batch);
  else
    integrate_accurately(
        scene, accuracy == Accuracy::check ? checking_solver(scene, coarse) : coarse, batch);
  return values;
}

}  // namespace trebsweep
