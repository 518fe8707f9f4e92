#pragma once

#include <string>
#include <vector>

namespace trebsweep {

/// A column of printed text.
struct TextColumn {
  std::vector<std::string> cells;
  bool left = false;  ///< aligned to the left, else to the right
};

/// The lines of a table, whose columns have equal numbers of cells and are two spaces apart.
/// Without spaces at the ends of lines.
std::vector<std::string> aligned(const std::vector<TextColumn>& columns);

}  // namespace trebsweep
