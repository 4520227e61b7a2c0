// SPDX-License-Identifier: MIT
#include <cstdio>
#include <new>

#include "offline/base/error.hpp"
#include "offline/cli/commands.hpp"
#include "offline/cli/completion.hpp"
#include "offline/cli/messages.hpp"

namespace {

using namespace mdhcal::offline;

// The exit statuses of the program, held stable.
constexpr int done = 0;
constexpr int check_failed = 1;
constexpr int bad_input = 2;

// The command that the arguments got to, for a hint at its help.
std::string command_line(const CLI::App& app) {
  const auto chosen = app.get_subcommands();
  return chosen.empty() ? app.get_name() : app.get_name() + ' ' + chosen.front()->get_name();
}

std::vector<const CLI::App*> all_commands(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App*) { return true; });
}

// The first word, if it is meant to be a command and is none.
std::string unknown_command(const CLI::App& app, int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word.empty() || word[0] == '-') continue;
    for (const CLI::App* command : all_commands(app)) {
      if (command->get_name() == word) return {};
    }
    return word;
  }
  return {};
}

int usage_error(const CLI::App& app, const CLI::ParseError& error, const std::string& unknown) {
  if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success)) {
    return app.exit(error);  // --help or --version
  }
  if (!unknown.empty()) {
    std::string commands;
    for (const CLI::App* command : all_commands(app)) {
      commands += (commands.empty() ? "" : ", ") + command->get_name();
    }
    complain("Found the command \"" + unknown + "\"; expected one of: " + commands + ".");
    return bad_input;
  }
  std::string message = error.what();
  while (!message.empty() && (message.back() == '\n' || message.back() == '.')) message.pop_back();
  complain(message + "; expected as in \"" + command_line(app) + " --help\".");
  return bad_input;
}

int run(int argc, char** argv) {
  CLI::App app{"Calibrate an arm on the host, correct it in the controller.", "mdhcal"};
  app.set_version_flag("--version", MDHCAL_TOOL_VERSION, "Print the version and exit");
  app.require_subcommand(1);
  app.fallthrough();
  bool quiet = false, verbose = false;
  CLI::Option* silent = app.add_flag("--quiet", quiet, "Say nothing but errors");
  app.add_flag("--verbose", verbose, "Say also what was decided and why")->excludes(silent);
  app.footer(
      "Example:\n"
      "  mdhcal calibrate robot.toml measured.csv -o result\n"
      "Exit status: 0 done; 1 a check did not hold or a calibration was refused; 2 bad usage or input.");
  // Commands run while the arguments are parsed: what the flags say must be known by then.
  app.parse_complete_callback([&] {
    set_verbosity(quiet ? Verbosity::quiet : verbose ? Verbosity::verbose : Verbosity::normal);
  });
  add_commands(app);
  add_completion(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return usage_error(app, error, unknown_command(app, argc, argv));
  } catch (const InputError& error) {
    complain(error.what());
    return bad_input;
  } catch (const Refusal& error) {
    complain(error.what());
    return check_failed;
  }
  // A full disk or a closed pipe must not pass for success.
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
    complain("The output cannot be written to the end.");
    return bad_input;
  }
  return done;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::bad_alloc&) {
    complain("There is not enough memory for this input.");
  } catch (const std::exception& error) {
    complain(std::string("Internal error, please report it: ") + error.what() + ".");
  }
  return bad_input;
}
