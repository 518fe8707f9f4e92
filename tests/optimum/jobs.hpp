#pragma once

#include <span>
#include <vector>

#include "trebsweep/job/job.hpp"
#include "trebsweep/job/key.hpp"
#include "trebsweep/optimum/design_space.hpp"
#include "trebsweep/swing/integrate.hpp"

namespace trebsweep {

/// The values of a field at designs, by another stepper than the search's; NaN without a release.
inline std::vector<double> accurate_values(const Job& job, Field field,
                                           std::span<const Design<double>> designs) {
  std::vector<SwingResult> swings(designs.size());
  std::vector<double> values(designs.size());
  const Solver solver = checking_solver(job.scene, solver_of("vern8", 1e-13, job.solver));
  integrate_accurately(job.scene, solver, {designs, swings, {&field, 1}, values});
  return values;
}

inline double accurate_value(const Job& job, Field field, const Design<double>& design) {
  return accurate_values(job, field, {&design, 1})[0];
}

/// The values of the objective, which is a field.
inline std::vector<double> accurate_objectives(const Job& job,
                                               std::span<const Design<double>> designs) {
  return accurate_values(job, field_of(job.optimum.objective).value(), designs);
}

inline double accurate_objective(const Job& job, const Design<double>& design) {
  return accurate_objectives(job, {&design, 1})[0];
}

/// Designs as parameters, a column each.
inline Eigen::MatrixXd to_parameters(const std::vector<Design<double>>& designs) {
  Eigen::MatrixXd all(length_count, designs.size());
  for (Eigen::Index i = 0; const Design<double>& design : designs)
    all.col(i++) = to_parameters(design);
  return all;
}

/// By how much r2 + r3 is beyond its limit; negative without one.
inline double sum_excess(const Job& job, const Design<double>& design) {
  const DesignSpace space = design_space(job);
  return space.limits.empty() ? -1 : space.limits.front().excess(job.scene, design);
}

/// The designs of a cube with `width` points along each edge around a centre.
inline std::vector<Design<double>> cube(const Design<double>& centre, double spacing, int width) {
  std::vector<Design<double>> designs;
  const auto offset = [&](int i) { return spacing * (i - (width - 1) / 2.0); };
  for (int i = 0; i < width; ++i)
    for (int j = 0; j < width; ++j)
      for (int k = 0; k < width; ++k)
        designs.push_back({centre.r1 + offset(i), centre.r3 + offset(j), centre.r2 + offset(k)});
  return designs;
}

/// A job with options of the command line, and one with the text of a job file.
inline Job job_with(const Overrides& options) { return parse_job("", "job.cfg", options); }
inline Job job_from(const std::string& text) { return parse_job(text, "job.cfg", {}); }

}  // namespace trebsweep
