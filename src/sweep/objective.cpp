#include "trebsweep/sweep/objective.hpp"

#include <algorithm>
#include <limits>

namespace trebsweep {

std::vector<Field> deciding_fields(const Job& job) {
  std::vector<Field> fields{job.optimum.objective};
  for (const Constraint& constraint : job.optimum.constraints) fields.push_back(constraint.field);
  if (job.output.optimum_filter == OptimumFilter::taut) fields.push_back(Field::slack);
  return fields;
}

std::vector<Field> additional_fields(const std::vector<Field>& fields) {
  std::vector<Field> additional;
  for (const Field field : fields)
    if (!is_basic(field) && std::ranges::count(additional, field) == 0) additional.push_back(field);
  return additional;
}

std::vector<double> objectives(const Batch& batch, const Job& job) {
  std::vector<double> values(batch.results.size());
  for_each_value(batch, job.optimum.objective,
                 [&](std::size_t n, double value) { values[n] = value; });
  const auto exclude_unless = [&](Field field, auto qualifies) {
    for_each_value(batch, field, [&](std::size_t n, double value) {
      if (!qualifies(value)) values[n] = std::numeric_limits<double>::quiet_NaN();
    });
  };
  for (const Constraint& constraint : job.optimum.constraints)
    exclude_unless(constraint.field, [&](double value) {  // false for NaN
      return violation(constraint, value) <= 0;
    });
  if (job.output.optimum_filter == OptimumFilter::taut)
    exclude_unless(Field::slack, [](double slack) { return slack == 1; });
  return values;
}

}  // namespace trebsweep
