#pragma once

#include <Eigen/Core>
#include <functional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "trebsweep/job/job.hpp"
#include "trebsweep/job/unit.hpp"

namespace trebsweep {

/// There is no optimum, and why. The program exits with code 1.
struct NoOptimum : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// What a search chooses: the lengths r1, r3 and r2, m, and the values of the job's variables, in
/// the units of their keys. Several of them are the columns of a matrix.
using Parameters = Eigen::VectorXd;

/// The number of parameters that are lengths.
inline constexpr Eigen::Index length_count = 3;

/// A limit of a design space that depends on several parameters.
struct SpaceLimit {
  std::string text;  ///< "r2 + r3 <= 1.5"
  /// By how much a design in a scene is beyond the limit, m.
  std::function<double(const Scene&, const Design<double>&)> excess;
};

/// The continuous region that a lattice samples, closed, and the box of the job's variables. The
/// ends of a fixed length are equal.
struct DesignSpace {
  std::vector<std::string> names;  ///< of the parameters: "r1", "counterweight-hanger"
  std::vector<std::string> units;
  Parameters lower, upper;
  std::vector<SpaceLimit> limits;  ///< (47) and (49), as far as they are not bounds

  Eigen::Index size() const { return lower.size(); }
};

/// The design of some parameters.
Design<double> to_design(const Eigen::Ref<const Parameters>& parameters);

/// The lengths of a design, as the parameters of a job without variables.
Parameters to_parameters(const Design<double>& design);

/// The parameters to 0.1 micrometres: "r1 = 0.5114230, r2 = 0.9166028, r3 = 0.5833972 m", and the
/// values of the variables.
std::string to_text(const Parameters& parameters, std::span<const Variable> variables,
                    UnitSystem units = UnitSystem::si);

/// The job whose variables have some values.
Job with_variables(Job job, const Eigen::Ref<const Eigen::VectorXd>& values);

/// The region of a job. Throws NoOptimum if it is empty.
DesignSpace design_space(const Job& job);

}  // namespace trebsweep
