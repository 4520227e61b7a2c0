// SPDX-License-Identifier: MIT
#include "offline/cli/completion.hpp"

#include <cstdio>
#include <string>

namespace mdhcal::offline {

namespace {

// "{a,b,c}" in an option's type name, as IsMember puts it there, in the words that bash's compgen takes: "a b c".
std::string words_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const std::size_t open = type.find('{');
  const std::size_t close = type.find('}', open);
  if (open == std::string::npos || close == std::string::npos) return {};
  std::string words = type.substr(open + 1, close - open - 1);
  for (char& c : words) {
    if (c == ',') c = ' ';
  }
  return words;
}

std::string flags_of(const CLI::Option& option) {
  std::string flags;
  for (const std::string& name : option.get_lnames()) flags += " --" + name;
  for (const std::string& name : option.get_snames()) flags += " -" + name;
  return flags;
}

// The lines of the two case statements that one command gives: its options beside the `common` ones, and the words behind
// an option.
void describe(const std::string& name, const CLI::App& command, const std::string& common, std::string& options,
              std::string& words) {
  options += "    " + name + ") options=\"" + common;
  for (const CLI::Option* option : command.get_options()) {
    options += flags_of(*option);
    const std::string allowed = words_of(*option);
    if (allowed.empty()) continue;
    std::string flags = flags_of(*option);
    for (std::size_t at = flags.find(' '); at != std::string::npos;) {
      const std::size_t end = flags.find(' ', at + 1);
      words += "    \"" + name + flags.substr(at, end - at) + "\") words=\"" + allowed + "\" ;;\n";
      at = end;
    }
  }
  options += "\" ;;\n";
}

std::string bash_script(const CLI::App& app) {
  std::string commands, options, words;
  describe("\"\"", app, "", options, words);
  // What stands before a command may stand behind it too.
  const std::string common = " --quiet --verbose";
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    commands += ' ' + command->get_name();
    describe(command->get_name(), *command, common, options, words);
  }
  return "# bash completion of mdhcal: source <(mdhcal completion bash)\n"
         "_mdhcal() {\n"
         "  local current=\"${COMP_WORDS[COMP_CWORD]}\" previous=\"${COMP_WORDS[COMP_CWORD-1]}\"\n"
         "  local command=\"\" options=\"\" words=\"\" word\n"
         "  local commands=\"" + commands.substr(1) + "\"\n"
         "  for word in \"${COMP_WORDS[@]:1:COMP_CWORD-1}\"; do\n"
         "    if [[ \" $commands \" == *\" $word \"* ]]; then command=\"$word\"; break; fi\n"
         "  done\n"
         "  case \"$command $previous\" in\n" + words + "  esac\n"
         "  case \"$command\" in\n" + options + "  esac\n"
         "  if [[ -n \"$words\" ]]; then\n"
         "    COMPREPLY=($(compgen -W \"$words\" -- \"$current\"))\n"
         "  elif [[ \"$current\" == -* ]]; then\n"
         "    COMPREPLY=($(compgen -W \"$options\" -- \"$current\"))\n"
         "  elif [[ -z \"$command\" ]]; then\n"
         "    COMPREPLY=($(compgen -W \"$commands\" -- \"$current\"))\n"
         "  else\n"
         "    COMPREPLY=($(compgen -f -- \"$current\"))\n"
         "  fi\n"
         "}\n"
         "complete -o filenames -F _mdhcal mdhcal\n";
}

}  // namespace

void add_completion(CLI::App& app) {
  CLI::App* command = app.add_subcommand("completion", "Print a completion script for the shell");
  command->add_option("SHELL", "The shell")->required()->check(CLI::IsMember({"bash"}));
  command->footer("Example:\n  source <(mdhcal completion bash)");
  command->callback([&app] { std::fputs(bash_script(app).c_str(), stdout); });
}

}  // namespace mdhcal::offline
