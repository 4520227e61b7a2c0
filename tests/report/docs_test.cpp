// SPDX-License-Identifier: MIT
// The pages and the files that speak about the project: what can be checked in them is.
#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include "tests/support/program.hpp"

namespace {

namespace fs = std::filesystem;
using namespace mdhcal::tests;

const fs::path source = MDHCAL_SOURCE_DIR;

std::vector<fs::path> pages() {
  std::vector<fs::path> found{source / "README.md"};
  for (const auto& entry : fs::directory_iterator(source / "docs")) {
    if (entry.path().extension() == ".md") found.push_back(entry.path());
  }
  return found;
}

TEST(Docs, EverySourceNamesItsLicence) {
  const std::set<std::string> endings{".cpp", ".hpp", ".h", ".c", ".S", ".ld", ".py", ".sh", ".cmake", ".cff"};
  std::size_t seen = 0;
  for (const char* room : {"lib", "port", "offline", "tests", "cmake", "docs"}) {
    for (const auto& entry : fs::recursive_directory_iterator(source / room)) {
      const fs::path& path = entry.path();
      if (!endings.contains(path.extension().string()) && path.filename() != "CMakeLists.txt") continue;
      ++seen;
      std::istringstream lines(read_bytes(path.string()));
      std::string first, second;  // a script's first line names its interpreter
      std::getline(lines, first);
      std::getline(lines, second);
      EXPECT_NE((first + second).find("SPDX-License-Identifier: MIT"), std::string::npos) << path;
    }
  }
  EXPECT_GT(seen, 300u);
}

TEST(Docs, LinksBetweenPagesLeadSomewhere) {
  const std::regex link(R"(\]\(([^)#:]+)(#[^)]*)?\))");
  std::size_t seen = 0;
  for (const fs::path& page : pages()) {
    const std::string text = read_bytes(page.string());
    for (std::sregex_iterator at(text.begin(), text.end(), link), end; at != end; ++at, ++seen) {
      EXPECT_TRUE(fs::exists(page.parent_path() / (*at)[1].str())) << page << ": " << (*at)[1];
    }
  }
  EXPECT_GT(seen, 5u);
}

// Every line of a page that runs the tool names a command and options that there are.
TEST(Docs, CommandsAndOptionsOfThePagesExist) {
  std::map<std::string, std::string> help;
  const std::regex run(R"(^[ $|`(]*(?:build/host/bin/)?mdhcal ([^`|#>&;]*))"), option(R"((?:^|\s)(--?[a-z][a-z0-9-]*))");
  std::size_t seen = 0;
  for (const fs::path& page : pages()) {
    std::istringstream lines(read_bytes(page.string()));
    for (std::string line; std::getline(lines, line);) {
      std::smatch call;
      if (!line.starts_with("    ") && !line.starts_with("$ ")) continue;
      if (!std::regex_search(line, call, run)) continue;
      std::istringstream words(call[1].str());
      std::string command;
      for (std::string word; command.empty() && words >> word;) {
        if (word[0] != '-') command = word;
      }
      if (command.empty() || command == "COMMAND") continue;
      if (!help.contains(command)) {
        const Outcome outcome = run_mdhcal({command, "--help"});
        EXPECT_EQ(outcome.exit_code, 0) << page << ": " << line;
        help[command] = outcome.out + run_mdhcal({"--help"}).out;
      }
      const std::string rest = call[1].str();
      for (std::sregex_iterator at(rest.begin(), rest.end(), option), end; at != end; ++at, ++seen) {
        const std::string name = (*at)[1];
        EXPECT_TRUE(std::regex_search(help[command], std::regex("[ ,]" + name + "[ ,\n]"))) << page << ": " << line << ": " << name;
      }
    }
  }
  EXPECT_GT(seen, 20u);
}

// What the Citation File Format 1.2.0 asks for.
TEST(Docs, TheCitationFileIsValid) {
  const YAML::Node cff = YAML::LoadFile((source / "docs/CITATION.cff").string());
  EXPECT_EQ(cff["cff-version"].as<std::string>(), "1.2.0");
  for (const char* key : {"message", "title"}) EXPECT_FALSE(cff[key].as<std::string>().empty()) << key;
  EXPECT_EQ(cff["type"].as<std::string>(), "software");
  EXPECT_EQ(cff["license"].as<std::string>(), "MIT");
  EXPECT_NE(run_mdhcal({"--version"}).out.find(cff["version"].as<std::string>()), std::string::npos);
  const auto check_authors = [](const YAML::Node& authors) {
    ASSERT_GT(authors.size(), 0u);
    for (const auto& author : authors) EXPECT_TRUE(author["name"] || (author["family-names"] && author["given-names"]));
  };
  check_authors(cff["authors"]);
  ASSERT_GT(cff["references"].size(), 0u);
  for (const auto& reference : cff["references"]) {
    check_authors(reference["authors"]);
    EXPECT_FALSE(reference["title"].as<std::string>().empty());
    EXPECT_EQ(reference["type"].as<std::string>(), "article");
    EXPECT_TRUE(std::regex_match(reference["doi"].as<std::string>(), std::regex(R"(10\.\d{4,9}/\S+)")));
  }
}

TEST(Docs, TheApiReferenceHasNoWarnings) {
  const TemporaryFolder folder;
  RunOptions options;
  options.folder = source.string();
  options.input = read_bytes((source / "docs/Doxyfile").string()) + "OUTPUT_DIRECTORY = \"" + folder.path() +
                  "\"\nWARN_AS_ERROR = FAIL_ON_WARNINGS\n";
  const Outcome run = run_program("doxygen", {"-"}, options);
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.err, "");
  EXPECT_TRUE(fs::exists(folder / "html/index.html"));
}

}  // namespace
