#pragma once

#include <map>
#include <string>

namespace trebsweep {

/// A value given in a job file, and the number of its line.
struct Assignment {
  std::string value;
  int line;
};

/// The assignments of a job file by "section.key".
using Assignments = std::map<std::string, Assignment>;

/// Parses the INI text of a job file or scene file; `name` is the file's name, for messages. Throws
/// InputError, naming the line, where a line is neither a section nor an assignment, a key is given
/// twice, or a value contains a #.
Assignments parse_config(const std::string& text, const std::string& name);

/// The text of a job file or scene file. Throws InputError if it is missing, unreadable, not a
/// regular file, not text, or longer than 1 MiB.
std::string read_job_file(const std::string& path);

}  // namespace trebsweep
