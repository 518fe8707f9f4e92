#pragma once

#include <map>
#include <string>

namespace trebsweep {

/// Parses the INI text of a job file or scene file into values by "section.key". `name` is the
/// file's name, for messages. Throws InputError naming the line if a line is neither a section nor
/// an assignment, a key is given twice, or a value contains a #.
std::map<std::string, std::string> parse_config(const std::string& text, const std::string& name);

/// Reads a job file or scene file; `what` precedes its path in messages. Throws InputError if the
/// file is missing, unreadable, not a regular file, not text, or longer than 1 MiB.
std::string read_job_file(const std::string& path, const std::string& what = "job file ");

/// Reads a job file from stdin to its end. Throws InputError if stdin is empty or unreadable, a
/// signal arrives meanwhile, or what was read is not text or is longer than 1 MiB.
std::string read_job_from_stdin();

}  // namespace trebsweep
