#include "trebsweep/sweep/objective.hpp"

#include <limits>

namespace trebsweep {

std::vector<Field> deciding_fields(const Job& job) {
  std::vector<Field> fields{job.optimum.objective};
  for (const Constraint& constraint : job.optimum.constraints) fields.push_back(constraint.field);
  if (job.output.optimum_filter == OptimumFilter::taut) fields.push_back(Field::slack);
  return fields;
}

double objective(std::span<const double> values, const Job& job) {
  const auto& constraints = job.optimum.constraints;
  bool qualifies =
      job.output.optimum_filter == OptimumFilter::all || values[1 + constraints.size()] == 1;
  for (std::size_t c = 0; c < constraints.size(); ++c)
    qualifies = qualifies && violation(constraints[c], values[1 + c]) <= 0;  // false for NaN
  return qualifies ? values[0] : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace trebsweep
