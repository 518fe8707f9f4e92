#include "trebsweep/cli/options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/program_options.hpp>
#include <string>
#include <vector>

#include "trebsweep/job/key.hpp"

namespace trebsweep {
namespace {

namespace po = boost::program_options;

constexpr unsigned line_length = 100;
// For keys: so long that Boost starts each description on a new line.
constexpr unsigned description_length = line_length - 6;
constexpr std::string_view file_key = "output.file";

/// A value, taken as text so that to_number and refuse() check and report all values alike.
po::typed_value<std::string>* text(const char* placeholder) {
  return po::value<std::string>()->value_name(placeholder);
}

const char* const json_meaning = "print a JSON object instead of text";
const char* const dry_run_meaning =
    "print what the command will cost and what would be refused; write nothing";
const char* const progress_meaning = "progress on stderr: auto (default), bar, lines or none";

}  // namespace

bool uses(Command command, const Key& key) {
  const std::string section = key.section();
  if (command == Command::info) return false;
  if (section == "scene" || section == "solver") return true;
  if (command == Command::trace) return false;
  if (command == Command::assess)
    return section == "lattice" || section == "assess" || key.name == "output.file";
  if (command == Command::optimum && section == "output") return key.name == "output.optimum";
  return section != "assess";
}

po::options_description command_options(Command command) {
  po::options_description options("Options", line_length);
  auto add = options.add_options();
  add("help,h", "describe the command");
  if (command != Command::info) {
    add("help-keys", "describe every key of the job file");
    add("unset", po::value<std::vector<std::string>>()->value_name("KEY"),
        "remove a key of the job file, such as solver.tolerance; may be given several times");
  }
  switch (command) {
    case Command::sweep:
      add("dry-run", dry_run_meaning);
      add("json", json_meaning);
      add("overwrite", "replace an existing archive, or a partial one, and start from scratch");
      add("progress", text("STYLE"), progress_meaning);
      add("time-limit", text("TIME"),
          "stop with exit code 75 after this time: seconds, or [[days-]hours:]minutes:seconds");
      break;
    case Command::optimum:
      add("dry-run", dry_run_meaning);
      add("json", json_meaning);
      add("pareto", po::value<std::vector<std::string>>()->multitoken()->value_name("A,B [POINTS]"),
          "after the job: instead of one optimum, the Pareto front of two objectives, such as "
          "\"range, -peak-axle-load\" 20; 20 points unless given");
      add("units", text("NAME"),
          "units of the text: si (default), us (ft, mph, lbf, psi, lb, deg) or deg (the SI with "
          "degrees); keys, formulas and JSON stay in the SI");
      add("progress", text("STYLE"), progress_meaning);
      break;
    case Command::assess:
      add("dry-run", dry_run_meaning);
      add("json", json_meaning);
      add("overwrite", "replace an existing archive");
      add("progress", text("STYLE"), progress_meaning);
      break;
    case Command::trace:
      add("r1", text("NUMBER"), "length of the counterweight arm, m (required)");
      add("r2", text("NUMBER"), "length of the throwing arm, m (required)");
      add("r3", text("NUMBER"), "length of the sling, m (required)");
      add("interval", text("NUMBER"),
          "time between rows, s (default: every step of a fixed-step stepper, 0.01 s otherwise and "
          "for --flight)");
      add("flight", "print the flight from the release to the ground instead of the swing");
      break;
    case Command::info:
      add("json", json_meaning);
      add("verify", "compare every tile with its checksums");
      add("snapshot", text("PATH"), "write what is done of an unfinished sweep as an archive");
      add("progress", text("STYLE"), progress_meaning);
      break;
    case Command::text:
    case Command::version:
      break;
  }
  return options;
}

po::options_description shown_options(Command command) {
  po::options_description options = command_options(command);
  if (uses(command, *std::ranges::find(job_keys(), file_key, &Key::name)))
    options.add_options()("output.file,o", text("FILE"), "path of the archive (default: JOB.h5)");
  return options;
}

po::options_description key_options(Command command) {
  po::options_description options(line_length, description_length);
  const Job defaults;
  for (const std::string_view section : job_sections) {
    const bool several = command == Command::sweep && section == "scene";
    po::options_description group(
        fmt::format("Keys of [{}]{}", section,
                    several ? ", where a NUMBER may be several: first:last:step or a, b, c" : ""),
        line_length, description_length);
    if (section == "scene")
      group.add_options()(scene_file_key.c_str(), text("PATH"),
                          "file with keys of [scene], which take precedence over the job file");
    for (const Key& key : job_keys()) {
      if (key.section() != section || !uses(command, key)) continue;
      const std::string value = key.get(defaults);
      const std::string name = key.name + (key.name == file_key ? ",o" : "");
      group.add_options()(
          name.c_str(), text(key.placeholder.c_str()),
          (key.help() + (value.empty() ? "" : fmt::format(" (default: {})", value))).c_str());
    }
    if (!group.options().empty()) options.add(group);
  }
  return options;
}

}  // namespace trebsweep
