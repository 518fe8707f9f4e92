#include "trebsweep/job/constraint.hpp"

#include <fmt/format.h>

namespace trebsweep {

std::string to_text(const Constraint& constraint) {
  return fmt::format("{} {} {}", info(constraint.field).name,
                     constraint.is_upper ? "<=" : ">=", constraint.limit);
}

}  // namespace trebsweep
