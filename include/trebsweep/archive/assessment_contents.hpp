#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace trebsweep {

/// What the archive of an assessment holds, except for the values of its tables.
struct AssessmentContents {
  std::string job, source, history;
  std::vector<std::string> tables;  ///< names of the groups
};

/// Reads an assessment. Throws as read_contents() does.
AssessmentContents read_assessment(const std::filesystem::path& path);

}  // namespace trebsweep
