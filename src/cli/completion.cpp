#include "trebsweep/cli/completion.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <boost/algorithm/string.hpp>
#include <boost/program_options.hpp>

#include "trebsweep/cli/options.hpp"

namespace trebsweep {
namespace {

/// The long names of all options of a command, with keys.
std::string option_words(Command command) {
  boost::program_options::options_description options = command_options(command);
  if (command != Command::info) options.add(key_options(command));
  std::string words;
  for (const auto& option : options.options()) words += " --" + option->long_name();
  return words.substr(1);
}

/// The values of the keys that have a few, as cases of bash by the option before the value.
std::string value_cases() {
  const std::string few = "one of ";
  std::string cases, keys = scene_file_key;
  for (const Key& key : job_keys()) {
    keys += " " + key.name;
    if (key.placeholder == "NAME" && key.allowed.starts_with(few))
      cases += fmt::format("    --{}) words=\"{}\" ;;\n", key.name,
                           boost::erase_all_copy(key.allowed.substr(few.size()), ","));
  }
  return cases + fmt::format("    --unset) words=\"{}\" ;;\n", keys);
}

}  // namespace

std::string bash_completion() {
  std::string options;
  for (std::size_t c = 0; c < command_names.size(); ++c)
    options += fmt::format("    {}) options=\"{}\" ;;\n", command_names[c],
                           option_words(static_cast<Command>(c)));
  const std::string commands = fmt::format("{}", fmt::join(command_names, " "));
  // Without a word that fits, bash completes the name of a file.
  return fmt::format(R"(# bash completion of trebsweep, printed by `trebsweep completion`
_trebsweep() {{
  local word=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD - 1]}} options= words=
  case ${{COMP_WORDS[1]}} in
{}    help) options="{}" ;;
  esac
  case $before in
{}    *) [[ $word == -* || ${{COMP_WORDS[1]}} == help ]] && words=$options ;;
  esac
  ((COMP_CWORD == 1)) && words="{} help completion --help --version"
  mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word")
}}
complete -o default -F _trebsweep trebsweep
)",
                     options, commands, value_cases(), commands);
}

}  // namespace trebsweep
