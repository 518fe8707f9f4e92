#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "trebsweep/base/error.hpp"
#include "trebsweep/job/job.hpp"
#include "trebsweep/job/key.hpp"
#include "trebsweep/job/lattice.hpp"

namespace trebsweep {

// The scenes of a study are the product of its outer axes, numbered with the last axis fastest. A
// job without outer axes has one scene, number 0.

inline bool is_study(const Job& job) { return !job.outer_axes.empty(); }

std::uint64_t count_scenes(const Job& job);

/// The key of an outer axis.
const Key& key_of(const OuterAxis& axis);

/// Throws InputError if a job has more than 1e6 scenes. It names the last outer axis.
void check_scene_count(const Job& job);

/// The position of a scene along each outer axis.
std::vector<std::uint64_t> outer_index(const Job& job, std::uint64_t scene);

/// The scene with a number.
Scene scene_at(const Job& job, std::uint64_t scene);

/// The job of a single scene: the same without outer axes.
Job job_at(const Job& job, std::uint64_t scene);

/// The values of the outer axes in a scene: "projectile-mass = 100 kg, fulcrum-height = 2 m".
std::string outer_values_text(const Job& job, std::uint64_t scene);

/// Calls f(). Adds the values of the outer axes in a scene to the message of an InputError.
template <class F>
void name_scene_in_errors(const Job& job, std::uint64_t scene, F f) {
  try {
    f();
  } catch (const InputError& error) {
    if (!is_study(job)) throw;
    throw InputError(std::string(error.what()) + " (in the scene with " +
                     outer_values_text(job, scene) + ")");
  }
}

/// Throws InputError if a job has several scenes: it names a key with several values, and ends with
/// `reason`, why one is required.
void require_one_scene(const Job& job, const std::string& reason);

/// The scenes of a job and their lattices, in a common box: its axes are the unions of theirs.
class Study {
 public:
  /// Throws InputError as Lattice does, and if the box has more than 1e15 cells over all scenes.
  explicit Study(const Job& job);

  const Job& job() const { return job_; }
  std::uint64_t scenes() const { return lattice_of_.size(); }

  /// The different lattices, in the common box.
  const std::vector<Lattice>& lattices() const { return lattices_; }

  /// The number of a scene's lattice among lattices().
  std::uint32_t lattice_of(std::uint64_t scene) const { return lattice_of_[scene]; }

  const Lattice& lattice(std::uint64_t scene) const { return lattices_[lattice_of_[scene]]; }

  /// The lattice of a scene in a box of its own.
  const Lattice& own_lattice(std::uint64_t scene) const { return own_[lattice_of_[scene]]; }

  /// The values of r1, r3 and r2 of the box, m.
  const LatticeAxes& axes() const { return lattices_.front().axes(); }

  /// The extent of the box.
  Index3 extent() const { return lattices_.front().extent(); }

  /// The designs of all scenes.
  std::uint64_t designs() const;

  /// The index of a cell in the flattened boxes of all scenes, r2 fastest.
  std::uint64_t cell(std::uint64_t scene, const Index3& index) const;

  /// The number of cells of all boxes.
  std::uint64_t cells() const;

  /// The scene and the design of a cell that holds one.
  std::pair<std::uint64_t, Design<double>> design(std::uint64_t cell) const;

 private:
  Job job_;
  std::vector<Lattice> own_;               // the different ones, each in its own box
  std::vector<Lattice> lattices_;          // the same in the common box
  std::vector<std::uint32_t> lattice_of_;  // of each scene
};

}  // namespace trebsweep
