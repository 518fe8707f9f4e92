#include "trebsweep/sweep/objective.hpp"

#include <limits>

namespace trebsweep {

std::vector<Field> deciding_fields(const Job& job) {
  std::vector<Field> fields{job.optimum.objective};
  const std::vector<Field> constrained = fields_of(job.optimum.constraints);
  fields.insert(fields.end(), constrained.begin(), constrained.end());
  if (job.output.optimum_filter == OptimumFilter::taut) fields.push_back(Field::slack);
  return fields;
}

double objective(std::span<const double> values, const Job& job, const Scene& scene,
                 const Design<double>& design) {
  const auto& constraints = job.optimum.constraints;
  if (constraints.empty() && job.output.optimum_filter == OptimumFilter::all) return values[0];
  const std::vector<Field> fields = deciding_fields(job);
  const Operands operands{scene, design, fields, values.first(fields.size())};
  bool qualifies = job.output.optimum_filter == OptimumFilter::all || operands.values.back() == 1;
  for (const Constraint& c : constraints)
    qualifies = qualifies && violation(c, c.expression.value(operands)) <= 0;  // false for NaN
  return qualifies ? values[0] : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace trebsweep
