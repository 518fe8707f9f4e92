#pragma once

#include <cstdint>
#include <span>

#include "trebsweep/model/scene.hpp"
#include "trebsweep/swing/field.hpp"
#include "trebsweep/swing/status.hpp"

namespace trebsweep {

/// The result that every swing has.
struct SwingResult {
  double speed;         ///< m/s, NaN without a release
  double release_time;  ///< s, NaN without a release
  std::uint64_t steps;  ///< tried, rejected ones included
  Status status;
};

/// Designs to integrate, and the arrays that receive their results.
struct Batch {
  std::span<const Design<double>> designs;
  std::span<SwingResult> results;      ///< results[n] belongs to designs[n]
  std::span<const Field> fields = {};  ///< fields to compute, which may repeat
  std::span<double> values = {};       ///< values[n * fields.size() + f] is fields[f] of designs[n]

  Batch slice(std::size_t first, std::size_t count) const {
    return {designs.subspan(first, count), results.subspan(first, count), fields,
            values.subspan(first * fields.size(), count * fields.size())};
  }
};

/// The cost of integrating a batch.
struct Work {
  std::uint64_t lane_steps;   ///< steps made by all lanes, including idle ones
  std::uint64_t evaluations;  ///< evaluations of the right-hand side in the designs' steps
};

}  // namespace trebsweep
