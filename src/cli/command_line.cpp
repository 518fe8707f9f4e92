#include "trebsweep/cli/command_line.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <boost/algorithm/string.hpp>
#include <boost/program_options.hpp>
#include <cmath>

#include "trebsweep/base/error.hpp"
#include "trebsweep/base/number.hpp"
#include "trebsweep/cli/completion.hpp"
#include "trebsweep/cli/help.hpp"
#include "trebsweep/cli/manual.hpp"
#include "trebsweep/cli/options.hpp"
#include "trebsweep/job/key.hpp"
#include "trebsweep/job/unit.hpp"

namespace trebsweep {
namespace {

namespace po = boost::program_options;

/// In the order of ProgressStyle.
constexpr std::array<std::string_view, 4> progress_names{"auto", "bar", "lines", "none"};

Command to_command(const std::string& name) {
  const auto found = std::ranges::find(command_names, name);
  if (found == command_names.end())
    throw InputError(fmt::format("{}: unknown command; the commands are {}, help and completion",
                                 shortened(name), fmt::join(command_names, ", ")));
  return static_cast<Command>(found - command_names.begin());
}

/// The place of an option's value among its names.
std::ptrdiff_t place_of(const char* option, const std::string& value,
                        std::span<const std::string_view> names) {
  const auto found = std::ranges::find(names, value);
  if (found == names.end()) refuse(option, value, fmt::format("one of {}", fmt::join(names, ", ")));
  return found - names.begin();
}

/// Parses the arguments after the command.
po::variables_map parse_options(Command command, int argc, const char* const* argv) {
  po::options_description options;
  options.add(command_options(command));
  if (command != Command::info) options.add(key_options(command));
  options.add_options()("job", po::value<std::vector<std::string>>());
  po::positional_options_description positions;
  positions.add("job", -1);
  constexpr int exact =
      po::command_line_style::unix_style & ~po::command_line_style::allow_guessing;
  po::variables_map given;
  try {
    po::store(po::command_line_parser(argc - 1, argv + 1)
                  .options(options)
                  .positional(positions)
                  .style(exact)
                  .run(),
              given);
  } catch (const po::unknown_option& unknown) {
    throw InputError(fmt::format("{}: unknown option of {}; 'trebsweep {} --help' lists them",
                                 shortened(unknown.get_option_name()), argv[1], argv[1]));
  } catch (const po::error& error) {
    throw InputError(
        fmt::format("{}; see 'trebsweep {} --help'", shortened(error.what()), argv[1]));
  }
  return given;
}

std::string text_of(const po::variables_map& given, const std::string& option) {
  return given[option].as<std::string>();
}

double length(const po::variables_map& given, const std::string& option) {
  if (!given.count(option))
    throw InputError(fmt::format("--{}: missing; give a length in metres", option));
  return to_number(option, text_of(given, option), physical, "m");
}

/// The positional argument: the path of the job file, or of the archive for `info`.
std::string file_of(Command command, const po::variables_map& given) {
  const bool info = command == Command::info;
  if (!given.count("job"))
    throw InputError(info ? "no archive given; give the path of one"
                          : "no job file given; try jobs/paper.cfg");
  const auto& files = given["job"].as<std::vector<std::string>>();
  if (files.size() > 1)
    throw InputError(fmt::format("{}: only one {} can be given", shortened(files[1]),
                                 info ? "archive" : "job file"));
  return files[0];
}

Overrides overrides_of(const po::variables_map& given) {
  Overrides overrides;
  for (const Key& key : job_keys())
    if (given.count(key.name)) overrides[key.name] = text_of(given, key.name);
  if (given.count(scene_file_key)) overrides[scene_file_key] = text_of(given, scene_file_key);
  return overrides;
}

/// Two objectives and, unless there are to be 20, a number of points.
ParetoSpec to_pareto(const std::vector<std::string>& words) {
  const std::string value = fmt::format("{}", fmt::join(words, " "));
  std::vector<std::string> parts;
  boost::split(parts, words[0], boost::is_any_of(","));
  for (std::string& part : parts) boost::trim(part);
  double points = 20;
  constexpr double fewest = 3, most = 1000;
  if (words.size() == 2 && (!parse_number(words[1], points) || points != std::round(points)))
    points = 0;
  if (parts.size() != 2 || parts[0] == parts[1] || words.size() > 2 || points < fewest ||
      points > most)
    refuse("pareto", value,
           fmt::format("given after the job, as two different objectives and a number of points "
                       "from {} to {}: "
                       "\"range, -peak-axle-load\" 20",
                       fewest, most));
  return {parts[0], parts[1], static_cast<std::size_t>(points)};
}

/// The text to print for arguments such as `help` and `--help`; nothing if they are a command's.
std::optional<std::string> text_about(const std::vector<std::string>& words) {
  const std::string& first = words[0];
  if (first == "--help" || first == "-h") return general_help();
  if (first != "help" && first != "completion" && first != "man") return std::nullopt;
  if (words.size() > (first == "help" ? 2 : 1))
    throw InputError(fmt::format("{}: one word too many after {}", shortened(words.back()), first));
  if (first == "completion") return bash_completion();
  if (first == "man") return manual_page();
  return words.size() == 1 ? general_help() : command_help(to_command(words[1]));
}

}  // namespace

CommandLine parse_command_line(int argc, const char* const* argv) {
  if (argc < 2) throw InputError("no command given; try 'trebsweep --help'");
  CommandLine line;
  const std::string first = argv[1];
  if (first == "--version") {
    line.command = Command::version;
    return line;
  }
  if (const auto text = text_about({argv + 1, argv + argc})) {
    line.text = *text;
    return line;
  }

  const Command command = to_command(first);
  const po::variables_map given = parse_options(command, argc, argv);
  if (given.count("help") || given.count("help-keys")) {
    line.text = given.count("help") ? command_help(command) : key_help(command);
    return line;
  }

  line.command = command;
  line.file = file_of(command, given);
  line.overrides = overrides_of(given);
  if (given.count("unset")) line.unset = given["unset"].as<std::vector<std::string>>();
  line.overwrite = given.count("overwrite") > 0;
  line.json = given.count("json") > 0;
  line.dry_run = given.count("dry-run") > 0;
  if (given.count("pareto"))
    line.pareto = to_pareto(given["pareto"].as<std::vector<std::string>>());
  line.flight = given.count("flight") > 0;
  line.verify = given.count("verify") > 0;
  if (given.count("snapshot")) line.snapshot = text_of(given, "snapshot");
  if (command == Command::info && line.json && (line.verify || !line.snapshot.empty()))
    throw InputError("--json: must be left out with --verify and --snapshot");
  if (given.count("progress"))
    line.progress = static_cast<ProgressStyle>(
        place_of("progress", text_of(given, "progress"), progress_names));
  if (given.count("units"))
    line.units =
        static_cast<UnitSystem>(place_of("units", text_of(given, "units"), unit_system_names));
  if (given.count("time-limit"))
    line.time_limit = to_seconds("time-limit", text_of(given, "time-limit"));
  if (given.count("interval"))
    line.interval = to_number("interval", text_of(given, "interval"), positive, "s");
  if (command == Command::trace)
    line.design = {length(given, "r1"), length(given, "r3"), length(given, "r2")};
  return line;
}

}  // namespace trebsweep
