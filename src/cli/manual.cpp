#include "trebsweep/cli/manual.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/algorithm/string.hpp>
#include <boost/program_options.hpp>
#include <string_view>
#include <vector>

#include "trebsweep/base/version.hpp"
#include "trebsweep/cli/exit_code.hpp"
#include "trebsweep/cli/help.hpp"
#include "trebsweep/cli/options.hpp"

namespace trebsweep {
namespace {

namespace po = boost::program_options;

/// A text with the characters escaped that have a meaning in man's format.
std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    const bool starts_line = result.empty() || result.back() == '\n';
    if (starts_line && (c == '.' || c == '\'')) result += "\\&";
    if (c == '\\' || c == '-') result += '\\';
    result += c == '\\' ? 'e' : c;
  }
  return result;
}

/// Paragraphs, which are separated by empty lines; those with indented lines keep their lines.
std::string paragraphs(std::string text) {
  std::string result;
  while (!text.empty()) {
    const std::size_t end = text.find("\n\n");
    std::string part = text.substr(0, end);
    text.erase(0, end == text.npos ? end : end + 2);
    boost::trim_right(part);
    result += part.starts_with(' ') ? fmt::format(".PP\n.nf\n{}\n.fi\n", escaped(part))
                                    : fmt::format(".PP\n{}\n", escaped(part));
  }
  return result;
}

std::string tagged(const std::string& name, const std::string& value, std::string_view meaning) {
  return fmt::format(".TP\n\\fB{}\\fR {}\n{}\n", escaped(name), escaped(value), escaped(meaning));
}

/// Options as "-h, --help".
std::string option_list(const po::options_description& options) {
  std::string text;
  for (const auto& option : options.options()) {
    std::string name = option->format_name();
    boost::replace_all(name, " [ ", ", ");
    boost::erase_all(name, " ]");
    text += tagged(name, option->format_parameter(), option->description());
  }
  return text;
}

std::string command_section(Command command) {
  const auto& [usage, brief, about] = text_of(command);
  return fmt::format(".SS {}\n", escaped(usage)) + paragraphs(std::string(about)) +
         option_list(shown_options(command));
}

/// Every key with its meaning, default and values, by section.
std::string key_sections() {
  std::string text;
  const Job defaults;
  for (const std::string_view section : job_sections) {
    text += fmt::format(".SS [{}]\n", section);
    if (section == "scene")
      text += tagged(scene_file_key, "PATH", "file with keys of [scene] only");
    for (const Key& key : job_keys()) {
      if (key.section() != section) continue;
      const std::string value = key.get(defaults);
      text += tagged(key.name, key.placeholder,
                     key.help() + (value.empty() ? "" : fmt::format(" (default: {})", value)));
    }
  }
  return text;
}

}  // namespace

std::string manual_page() {
  const std::string version = version_text();
  std::string text = fmt::format(".TH TREBSWEEP 1 \"\" \"{}\" \"User Commands\"\n",
                                 escaped(version.substr(0, version.find(" ("))));
  text += ".SH NAME\ntrebsweep \\- explore the design space of a trebuchet\n.SH SYNOPSIS\n";
  for (std::size_t c = 0; c < command_names.size(); ++c)
    text += escaped(text_of(static_cast<Command>(c)).usage) + "\n.br\n";
  text += ".SH DESCRIPTION\n" + paragraphs(job_text());
  text += ".SH COMMANDS\n";
  for (std::size_t c = 0; c < command_names.size(); ++c)
    text += command_section(static_cast<Command>(c));
  text += ".SH KEYS\n" +
          paragraphs(
              "Each key of a job file is an option as well, such as "
              "--solver.tolerance 1e-9.\n") +
          key_sections();
  text += ".SH EXIT STATUS\n";
  for (const auto& [code, meaning] : exit_code::all)
    text += tagged(fmt::format("{}", code), "", meaning);
  return text + ".SH SEE ALSO\n.BR mpirun (1)\n";
}

}  // namespace trebsweep
