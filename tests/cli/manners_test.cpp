// SPDX-License-Identifier: MIT
// How the program behaves on a command line, whatever the command.
#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <regex>
#include <set>
#include <sstream>

#include "tests/cli/cli.hpp"

namespace {

using namespace mdhcal::tests;

// The commands that `mdhcal --help` lists.
std::vector<std::string> commands() {
  const std::string help = run_mdhcal({"--help"}).out;
  std::vector<std::string> names;
  std::size_t at = help.find("Subcommands:\n");
  while (at != std::string::npos && (at = help.find('\n', at)) != std::string::npos && help.compare(at, 3, "\n  ") == 0) {
    const std::size_t end = help.find(' ', at + 3);
    if (help[at + 3] != ' ') names.push_back(help.substr(at + 3, end - at - 3));
    ++at;
  }
  return names;
}

TEST(CommandLine, EveryCommandHasHelpWithAnExampleOfItself) {
  const auto names = commands();
  ASSERT_GE(names.size(), 5U);
  for (const std::string& name : names) {
    const Outcome run = run_mdhcal({name, "--help"});
    EXPECT_EQ(run.exit_code, 0) << name;
    EXPECT_NE(run.out.find("\nExample"), std::string::npos) << name;
    EXPECT_NE(run.out.find("mdhcal " + name + ' ', run.out.find("\nExample")), std::string::npos) << name << ": " << run.out;
    EXPECT_EQ(run.err, "") << name;
  }
}

TEST(CommandLine, VersionIsPrinted) {
  const Outcome run = run_mdhcal({"--version"});
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_EQ(run.out.substr(0, 7), "mdhcal ");
}

TEST(CommandLine, BadUsageIsOneSentenceAndExitStatusTwo) {
  const std::vector<std::vector<std::string>> cases = {
      {}, {"calibrat"}, {"forward"}, {"forward", "a.blob", "b.csv", "--fram", "base"}, {"pack", "a.toml"},
      {"forward", "a", "b", "--frame", "moon"}, {"completion", "csh"}, {"--quiet", "--verbose", "pack", "a", "-o", "b"}};
  for (const auto& arguments : cases) {
    const Outcome run = run_mdhcal(arguments);
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_EQ(run.out, "");
    EXPECT_EQ(run.err.substr(0, 8), "mdhcal: ") << run.err;
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    EXPECT_NE(run.err.find("expected"), std::string::npos) << run.err;
    EXPECT_EQ(run.err.find('\033'), std::string::npos) << "colour in a file";
  }
}

TEST(CommandLine, QuietSaysNothingButErrors) {
  const TemporaryFolder folder;
  ASSERT_EQ(run_mdhcal({"pack", example("robot.toml"), "-o", folder / "a.blob"}).exit_code, 0);
  const Outcome normal = run_mdhcal({"forward", folder / "a.blob", example("nine.csv")});
  EXPECT_NE(normal.err.find("unknown columns are ignored: \"x_mm\""), std::string::npos) << normal.err;
  // The flag may stand before and behind the command.
  EXPECT_EQ(run_mdhcal({"--quiet", "forward", folder / "a.blob", example("nine.csv")}).err, "");
  EXPECT_EQ(run_mdhcal({"forward", folder / "a.blob", example("nine.csv"), "--quiet"}).err, "");
  EXPECT_NE(run_mdhcal({"forward", folder / "b.blob", example("nine.csv"), "--quiet"}).err, "");
}

TEST(CommandLine, ColourIsForTerminalsWithoutNoColor) {
  // script(1) gives the program a terminal.
  const auto on_a_terminal = [](const char* no_color) {
    return run_program("script", {"-qec", std::string(MDHCAL_PROGRAM) + " pack", "/dev/null"},
                       {"", "", {{"TERM", "xterm"}, {"NO_COLOR", no_color}}});
  };
  EXPECT_NE(on_a_terminal("").out.find("\033[31mmdhcal:\033[0m"), std::string::npos);
  const Outcome plain = on_a_terminal("1");
  EXPECT_EQ(plain.out.find('\033'), std::string::npos) << plain.out;
  EXPECT_NE(plain.out.find("mdhcal: "), std::string::npos) << plain.out;
}

TEST(CommandLine, AFullDiskIsNoSuccess) {
  const TemporaryFolder folder;
  ASSERT_EQ(run_mdhcal({"pack", example("robot.toml"), "-o", folder / "a.blob"}).exit_code, 0);
  const Outcome run = run_program("bash", {"-c", '"' + std::string(MDHCAL_PROGRAM) + "\" --quiet forward \"" + (folder / "a.blob") +
                                                 "\" \"" + example("nine.csv") + "\" > /dev/full"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_NE(run.err.find("cannot be written"), std::string::npos) << run.err;
}

TEST(CommandLine, BashCompletesCommandsOptionsAndWords) {
  const TemporaryFolder folder;
  write_bytes(folder / "complete.sh", run_mdhcal({"completion", "bash"}).out + R"(
complete_line() {
  COMP_WORDS=("$@"); COMP_CWORD=$(( $# - 1 )); COMPREPLY=()
  _mdhcal; echo "${COMPREPLY[*]}"
}
complete_line mdhcal fo
complete_line mdhcal --quiet pac
complete_line mdhcal forward --fr
complete_line mdhcal forward a.blob --frame t
complete_line mdhcal --v
)");
  const Outcome run = run_program("bash", {folder / "complete.sh"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.out, "forward\npack\n--frame\ntracker\n--version --verbose\n") << run.err;
}

// The long options that a text names at the beginning of its lines, as --help lists them.
std::set<std::string> options_of(const std::string& help) {
  std::set<std::string> options;
  const std::regex option(R"((?:^|\n)  (?:-\w,)?(--[\w-]+))");
  for (std::sregex_iterator at(help.begin(), help.end(), option), end; at != end; ++at) options.insert((*at)[1]);
  return options;
}

TEST(CommandLine, BashCompletesEveryCommandAndOptionOfTheHelp) {
  const TemporaryFolder folder;
  std::string script = run_mdhcal({"completion", "bash"}).out +
                       "complete_line() { COMP_WORDS=(\"$@\"); COMP_CWORD=$(( $# - 1 )); COMPREPLY=(); _mdhcal; "
                       "echo \"${COMPREPLY[*]}\"; }\ncomplete_line mdhcal ''\ncomplete_line mdhcal --\n";
  const auto names = commands();
  for (const std::string& name : names) script += "complete_line mdhcal " + name + " --\n";
  write_bytes(folder / "complete.sh", script);
  std::istringstream lines(run_program("bash", {folder / "complete.sh"}).out);
  const auto next_line = [&] {
    std::string line;
    std::getline(lines, line);
    std::istringstream words(line);
    return std::set<std::string>(std::istream_iterator<std::string>(words), {});
  };
  EXPECT_EQ(next_line(), std::set<std::string>(names.begin(), names.end()));
  EXPECT_EQ(next_line(), options_of(run_mdhcal({"--help"}).out));
  for (const std::string& name : names) {
    auto expected = options_of(run_mdhcal({name, "--help"}).out);
    EXPECT_TRUE(expected.contains("--help")) << name;
    expected.insert({"--quiet", "--verbose"});
    EXPECT_EQ(next_line(), expected) << name;
  }
}

}  // namespace
