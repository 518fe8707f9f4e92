#include "trebsweep/sweep/objective.hpp"

#include <limits>

namespace trebsweep {

std::vector<Field> deciding_fields(const Job& job) {
  std::vector<Field> fields = job.optimum.objective.fields;
  const std::vector<Field> constrained = fields_of(job.optimum.constraints);
  fields.insert(fields.end(), constrained.begin(), constrained.end());
  if (job.output.optimum_filter == OptimumFilter::taut) fields.push_back(Field::slack);
  return fields;
}

double objective(const Operands& operands, const Job& job) {
  bool qualifies =
      job.output.optimum_filter == OptimumFilter::all || value_of(operands, Field::slack) == 1;
  for (const Constraint& c : job.optimum.constraints)
    qualifies = qualifies && violation(c, c.expression.value(operands)) <= 0;  // false for NaN
  return qualifies ? job.optimum.objective.value(operands)
                   : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace trebsweep
