#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "trebsweep/job/job.hpp"
#include "trebsweep/optimum/design_space.hpp"
#include "trebsweep/optimum/field_values.hpp"
#include "trebsweep/optimum/nonlinear_program.hpp"

namespace trebsweep {

/// The search for a job's optimum. The variables x of its nonlinear programs are the parameters
/// that are not fixed, each divided by its scale.
struct DesignProblem {
  MachineFamily machine;
  DesignSpace space;
  Expression objective;
  std::vector<Constraint> constraints;  ///< the job's; the last one is that of a taut sling, if any
  std::vector<Field> fields;            ///< of the objective and the constraints
  std::vector<double> scales;           ///< of the objective and the constraints
  std::vector<Eigen::Index> free;       ///< indices of the parameters that are not fixed
};

/// The problem of a job, scaled by the values at parameters with a release.
DesignProblem design_problem(const Job& job, const Parameters& typical);

/// The constraints on an optimum of a job: its own and, with output.optimum = taut, that of a taut
/// sling.
std::vector<Constraint> constraints_of(const Job& job);

/// The scale of a constraint: its limit or, if that is zero or far smaller, a height or a weight of
/// the machine, or the magnitude of a value of its field.
double scale_of(const Constraint& constraint, const Scene& scene, double value);

/// The conditions that a machine can be built: arm's tip, counterweight and projectile stay above
/// the ground, a rigid sling stays taut, and the angle phi1 - phi2 at the release is one of a pin.
std::vector<Constraint> build_constraints(const Scene& scene, const Solver& solver);

/// The job that a search solves: with optimum.buildable, it is subject to those build_constraints()
/// that its own constraints do not imply.
Job searched_job(const Job& job);

/// Between parameters and the variables of nonlinear programs.
Eigen::VectorXd to_scaled(const DesignProblem& problem, const Parameters& parameters);
Parameters to_parameters(const DesignProblem& problem, const Eigen::VectorXd& scaled);

/// By what a parameter is divided: the middle of its bounds or, if that is close to zero, half of
/// their distance.
double scale_of(const DesignSpace& space, Eigen::Index parameter);

/// The parameters that keys allow, each divided by the element of `units`: the bounds of a variable
/// beyond which its key allows no values, and everything else.
Domain allowed(const DesignProblem& problem, const Parameters& units);

/// The objective and the expressions of the constraints at parameters, a column for each, in a
/// machine.
Eigen::MatrixXd quantities(const DesignProblem& problem, const MachineFamily& machine,
                           const Eigen::MatrixXd& parameters, Accuracy accuracy = Accuracy::high);

/// The scaled objective and constraints at parameters, a column for each.
Eigen::MatrixXd values_at(const DesignProblem& problem, const Eigen::MatrixXd& parameters,
                          Accuracy accuracy = Accuracy::high);

/// The magnitude of the objective at parameters, scaled as the objective is.
double magnitude_at(const DesignProblem& problem, const Parameters& parameters);

/// Parameters that differ from the searched ones, and their part in the program.
struct Deviation {
  Parameters by;
  double weight;     ///< in the mean of the objectives; 0: not among the objectives
  bool constrained;  ///< whether the constraints hold there
};

/// What is made as large as possible over several deviations.
enum class Aggregate { worst, mean };

/// The nonlinear program of a problem, for designs with the given deviations. Its constraints are
/// those of the first constrained deviation, of the second and so on, and the limits of the space.
/// Adds the number of designs that it integrates to `integrated`.
NonlinearProgram program_of(const DesignProblem& problem, const std::vector<Deviation>& deviations,
                            Aggregate aggregate, std::uint64_t& integrated,
                            Accuracy accuracy = Accuracy::high);

/// The program of the designs themselves.
NonlinearProgram nominal_program(const DesignProblem& problem, std::uint64_t& integrated,
                                 Accuracy accuracy = Accuracy::high);

/// A limit of the optimum: a constraint, a limit of the space or a bound of a parameter.
struct Limit {
  std::string text;  ///< "r2 + r3 <= 1.5"
  std::string units;
  /// Turns the multiplier of the nonlinear program into the derivative of the optimum with respect
  /// to the limit.
  double factor;
};

/// An end of the interval in which a parameter can change, and the limits() of which it is one.
struct IntervalEnd {
  double value;
  std::size_t limit;
};

/// How far a parameter can change with the others as they are: to a bound, unless the parameter is
/// fixed, or a limit of the space. Infinite where there is no end.
std::array<IntervalEnd, 2> interval(const DesignProblem& problem, const Parameters& parameters,
                                    Eigen::Index parameter);

/// The limits in the order of the multipliers of the programs for a single deviation.
std::vector<Limit> limits(const DesignProblem& problem);

}  // namespace trebsweep
