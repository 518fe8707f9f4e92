#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "trebsweep/job/job.hpp"
#include "trebsweep/optimum/design_space.hpp"
#include "trebsweep/optimum/nonlinear_program.hpp"

namespace trebsweep {

/// The search for a job's optimum. The variables of its nonlinear programs are the lengths that are
/// not fixed, in the order r1, r3, r2, each divided by the middle of its range.
struct DesignProblem {
  Scene scene;
  Solver solver;
  DesignSpace space;
  std::vector<Field> fields;            ///< the objective, then fields_of() the constraints
  std::vector<Constraint> constraints;  ///< the job's; the last one is that of a taut sling, if any
  std::vector<double> scales;           ///< of the objective and the constraints
  std::vector<std::size_t> variables;   ///< indices of the lengths that are not fixed
};

/// The problem of a job, scaled by the values at a design with a release.
DesignProblem design_problem(const Job& job, const Design<double>& typical);

/// Whether r2 + r3 <= h0 (49) depends on the variables.
bool has_sum(const DesignProblem& problem);

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

Eigen::VectorXd to_variables(const DesignProblem& problem, const Design<double>& design);
Design<double> to_design(const DesignProblem& problem, const Eigen::VectorXd& variables);

/// The length (m) by which a variable is divided.
double length_scale(const DesignProblem& problem, std::size_t length);

/// The objective and the expressions of the constraints at designs of a scene, a column per design,
/// integrated accurately.
Eigen::MatrixXd quantities(const DesignProblem& problem, const Scene& scene, const Solver& solver,
                           std::span<const Design<double>> designs);

/// The scaled objective and constraints at designs, a column per design, integrated accurately.
Eigen::MatrixXd values_at(const DesignProblem& problem, std::span<const Design<double>> designs);

/// A design that differs from the searched one by (r1, r3, r2), m, and its part in the program.
struct Deviation {
  std::array<double, 3> lengths;
  double weight;     ///< in the mean of the objectives; 0: not among the objectives
  bool constrained;  ///< whether it must satisfy the constraints
};

/// What is made as large as possible over several deviations.
enum class Aggregate { worst, mean };

/// The nonlinear program of a problem, for designs with the given deviations. Its constraints are
/// those of the first constrained deviation, of the second and so on, and r2 + r3 <= h0 (49). Adds
/// the number of designs that it integrates to `integrated`.
NonlinearProgram program_of(const DesignProblem& problem, const std::vector<Deviation>& deviations,
                            Aggregate aggregate, std::uint64_t& integrated);

/// The program of the designs themselves.
NonlinearProgram nominal_program(const DesignProblem& problem, std::uint64_t& integrated);

/// A limit of the optimum: a constraint or a bound of the lengths.
struct Limit {
  std::string text;  ///< "r2 + r3 <= 1.5"
  std::string units;
  /// Turns the multiplier of the nonlinear program into the derivative of the optimum with respect
  /// to the limit.
  double factor;
};

/// The limits in the order of the multipliers of the programs for a single deviation.
std::vector<Limit> limits(const DesignProblem& problem);

}  // namespace trebsweep
