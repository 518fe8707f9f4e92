#pragma once

#include <string>

#include "trebsweep/job/job.hpp"

namespace trebsweep {

/// The job of a text, with values of the command line.
inline Job parse(const std::string& text, const Overrides& overrides = {}) {
  return parse_job(text, "my.cfg", overrides);
}

}  // namespace trebsweep
