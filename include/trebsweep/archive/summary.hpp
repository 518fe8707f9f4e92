#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "trebsweep/archive/scene_optimum.hpp"
#include "trebsweep/archive/tally.hpp"
#include "trebsweep/job/job.hpp"
#include "trebsweep/job/study.hpp"

namespace trebsweep {

/// The design with the largest objective among those that have a release and satisfy the job's
/// constraints.
struct Optimum {
  Design<double> design;
  double value;         ///< the objective, in the unit of its field
  double speed;         ///< m/s
  double release_time;  ///< s
  std::uint64_t scene = 0;
};

/// A design of a study.
struct PlacedDesign {
  std::uint64_t scene;
  Design<double> design;

  bool operator==(const PlacedDesign&) const = default;
};

/// An optimum between the designs of a lattice, and the error of its value.
struct RefinedOptimum {
  Optimum optimum;
  double error;  ///< in the unit of the value
};

/// The error of a sweep's speeds, measured on a sample of the lattice.
struct MeasuredError {
  double median;          ///< m/s: of designs spread evenly over the lattice
  double largest;         ///< m/s: of all designs of the sample
  double at_optimum;      ///< m/s: NaN without an optimum, or if it could not be measured
  std::uint64_t designs;  ///< in the sample
};

/// Result of a sweep, reduced over all ranks.
struct Summary {
  std::array<std::uint64_t, status_names.size()> statuses{};  ///< designs of each Status
  std::uint64_t steps = 0;                                    ///< steps tried, over all designs
  std::uint64_t lane_steps = 0;                 ///< steps of all lanes, including idle ones
  std::optional<Optimum> optimum;               ///< nothing if no design qualifies
  std::optional<RefinedOptimum> refined;        ///< nothing if it was not searched for
  std::vector<SceneOptimum> optima;             ///< of a study's scenes; on rank 0 only
  std::vector<PlacedDesign> first_of_statuses;  ///< the first design of each status that occurs
  std::optional<MeasuredError> error;           ///< nothing if it was not measured
  std::vector<std::string> warnings;            ///< reasons to doubt the result, a line for each
  double integration_seconds = 0;               ///< s: mean over the ranks
  double sweep_seconds = 0;                     ///< s: with writing, likewise
  bool complete = true;                         ///< false if the sweep was stopped

  std::uint64_t designs() const;

  /// The fraction of the lanes' steps in which the lane held a design.
  double utilisation() const;
};

/// The design in the best cell of a study as its optimum; nothing if no design qualifies.
std::optional<Optimum> optimum_at(const BestCell& best, const Study& study);

/// The summary of a tally of a study's designs.
Summary to_summary(const Tally& tally, const Study& study);

/// The optimum of all scenes of a study; nothing if the job does not refine optima, or none is
/// known.
std::optional<RefinedOptimum> best_refined(const Job& job, std::span<const SceneOptimum> optima);

/// The summary as lines of text for the user, without a newline after the last.
std::string to_text(const Summary& summary, const Job& job);

}  // namespace trebsweep
