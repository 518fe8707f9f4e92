#pragma once

#include <Eigen/Core>
#include <functional>
#include <span>
#include <vector>

#include "trebsweep/job/job.hpp"
#include "trebsweep/optimum/design_space.hpp"

namespace trebsweep {

/// How accurately designs are integrated, whatever the job's stepper and tolerance.
enum class Accuracy {
  coarse,  ///< by vern8 at a tolerance of 1e-6
  high,    ///< by vern8 at 1e-13, as in integrate_accurately()
  check    ///< the same by another stepper
};

/// The solver of Accuracy::coarse.
Solver coarse_solver(const Solver& solver);

/// The machines among which a search chooses: a scene and a solver in which parameters are designs.
struct MachineFamily {
  Scene scene;
  Solver solver;
  std::vector<Variable> variables;  ///< the values of these are those of the parameters
};

MachineFamily family_of(const Job& job);

/// That in which the variables have the values of some parameters.
MachineFamily at(const MachineFamily& machine, const Eigen::Ref<const Parameters>& parameters);

/// The values of fields at parameters, a row per field and a column per column of the parameters.
/// NaN without a release, and where a key does not allow the value of a variable.
Eigen::MatrixXd field_values(const MachineFamily& machine, Accuracy accuracy,
                             const Eigen::MatrixXd& parameters, std::span<const Field> fields);

/// Calls f for every column of parameters, with the operands of expressions there: the values of
/// fields are the columns of `values`.
void for_each_design(const MachineFamily& machine, const Eigen::MatrixXd& parameters,
                     std::span<const Field> fields, const Eigen::MatrixXd& values,
                     const std::function<void(Eigen::Index column, const Operands&)>& f);

}  // namespace trebsweep
