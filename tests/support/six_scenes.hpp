#pragma once

#include "trebsweep/job/job.hpp"

namespace trebsweep {

/// A study of two masses and three heights, whose lattices differ.
inline Job job_of_six_scenes() {
  return parse_job(
      "[scene]\nprojectile-mass = 50, 100\nfulcrum-height = 1.2, 1.5, 1.9\n"
      "[lattice]\nincrement = 0.05\n",
      "study.cfg", {});
}

}  // namespace trebsweep
