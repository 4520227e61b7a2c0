// SPDX-License-Identifier: MIT
// Runs every command of docs/tutorial.md and docs/own-robot.md in order, and the one of the README, and compares what they print.
#include <filesystem>
#include <sstream>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/program.hpp"

namespace {

namespace fs = std::filesystem;
using namespace mdhcal::tests;

struct Step {
  std::string command, output;
};

// The lines of the ```console blocks: "$ COMMAND", then what it prints.
std::vector<Step> steps_of(const std::string& page) {
  std::vector<Step> steps;
  std::istringstream lines(page);
  bool inside = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("```")) {
      inside = line == "```console";
    } else if (inside && line.starts_with("$ ")) {
      steps.push_back({line.substr(2), ""});
    } else if (inside && !steps.empty()) {
      steps.back().output += line + '\n';
    }
  }
  return steps;
}

void expect_what_the_page_says(const std::string& page, std::size_t least_steps) {
  const auto steps = steps_of(read_bytes(std::string(MDHCAL_SOURCE_DIR) + "/docs/" + page));
  ASSERT_GT(steps.size(), least_steps);
  const TemporaryFolder folder;
  fs::create_directory_symlink(std::string(MDHCAL_SOURCE_DIR) + "/offline", folder / "offline");
  fs::create_directory(folder / "bin");
  fs::create_symlink(MDHCAL_PROGRAM, folder / "bin/mdhcal");
  RunOptions options;
  options.folder = folder.path();
  for (const Step& step : steps) {
    const auto run = run_program("bash", {"-c", "exec 2>&1; PATH=\"$PWD/bin:$PATH\"; " + step.command}, options);
    EXPECT_EQ(run.out, step.output) << step.command;
  }
}

TEST(Tutorial, EveryCommandPrintsWhatThePageSays) { expect_what_the_page_says("tutorial.md", 15); }
TEST(Tutorial, OwnRobotAndTrackerPrintWhatThePageSays) { expect_what_the_page_says("own-robot.md", 8); }

// cmake/demo.sh prints the command, what it prints, and the files.
TEST(Readme, ShowsWhatTheDemoPrints) {
  const std::string page = read_bytes(std::string(MDHCAL_SOURCE_DIR) + "/README.md");
  const std::string program = "$ build/host/bin/mdhcal ";
  const std::size_t begin = page.find(program);
  const std::size_t line_end = page.find('\n', begin);
  const std::size_t files = page.find("Wrote:\n", line_end);
  ASSERT_LT(files, page.size());
  const std::string arguments = page.substr(begin + program.size(), line_end - begin - program.size());
  const TemporaryFolder folder;
  fs::create_directory_symlink(std::string(MDHCAL_SOURCE_DIR) + "/offline", folder / "offline");
  fs::create_directory(folder / "build");
  RunOptions options;
  options.folder = folder.path();
  const auto run = run_program("bash", {"-c", "exec 2>&1; " + std::string(MDHCAL_PROGRAM) + " " + arguments}, options);
  EXPECT_EQ(run.out, page.substr(line_end + 1, files - line_end - 1));
}

}  // namespace
