#include "trebsweep/base/text_table.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace trebsweep {

std::vector<std::string> aligned(const std::vector<TextColumn>& columns) {
  std::vector<std::string> lines(columns.front().cells.size());
  for (const auto& [cells, left] : columns) {
    std::size_t width = 0;
    for (const std::string& cell : cells) width = std::max(width, cell.size());
    const char* const gap = &columns.front().cells == &cells ? "" : "  ";
    for (std::size_t i = 0; i < cells.size(); ++i)
      lines[i] += left ? fmt::format("{}{:<{}}", gap, cells[i], width)
                       : fmt::format("{}{:>{}}", gap, cells[i], width);
  }
  for (std::string& line : lines) line.erase(line.find_last_not_of(' ') + 1);
  return lines;
}

}  // namespace trebsweep
