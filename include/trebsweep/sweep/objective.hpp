#pragma once

#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <vector>

#include "trebsweep/job/job.hpp"
#include "trebsweep/swing/batch.hpp"

namespace trebsweep {

/// The fields that decide which design is the optimum: the objective, those with a constraint, and
/// slack if only taut slings compete.
std::vector<Field> deciding_fields(const Job& job);

/// Those of some fields that are not part of SwingResult, each once, as a Batch takes them.
std::vector<Field> additional_fields(const std::vector<Field>& fields);

/// Calls f(n, value) with a field's values for the designs n of an integrated batch; flags and
/// counts are numbers. Throws std::logic_error if the batch does not have the field.
template <class F>
void for_each_value(const Batch& batch, Field field, F f) {
  const auto all = [&](auto value) {
    for (std::size_t n = 0; n < batch.results.size(); ++n) f(n, value(n));
  };
  switch (field) {
    case Field::speed:
      return all([&](std::size_t n) { return batch.results[n].speed; });
    case Field::release_time:
      return all([&](std::size_t n) { return batch.results[n].release_time; });
    case Field::status:
      return all([&](std::size_t n) { return static_cast<double>(batch.results[n].status); });
    case Field::steps:
      return all([&](std::size_t n) { return static_cast<double>(batch.results[n].steps); });
    default:
      break;
  }
  const auto found = std::ranges::find(batch.fields, field);
  if (found == batch.fields.end()) throw std::logic_error("a field that was not integrated");
  const auto f_index = static_cast<std::size_t>(found - batch.fields.begin());
  all([&](std::size_t n) { return batch.values[n * batch.fields.size() + f_index]; });
}

/// The objective of each design of an integrated batch that has the deciding_fields() of a job, in
/// the unit of its field. NaN for a design that violates a constraint or has no release, or whose
/// sling goes slack if only taut ones compete.
std::vector<double> objectives(const Batch& batch, const Job& job);

}  // namespace trebsweep
