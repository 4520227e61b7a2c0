// SPDX-License-Identifier: MIT
#include "offline/batch/batch.hpp"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>
#include <unistd.h>

#include "offline/base/error.hpp"
#include "offline/simulate/family.hpp"
#include "offline/simulate/measurement_text.hpp"
#include "offline/simulate/simulate.hpp"
#include "tests/support/program.hpp"

namespace {

namespace fs = std::filesystem;
using namespace mdhcal::offline;
using namespace mdhcal::tests;

// `count` simulated robots under folder/in and their manifest; one of them cannot be calibrated if `bad`.
void write_fleet(const TemporaryFolder& folder, std::size_t count, std::size_t poses, bool bad) {
  fs::create_directory(folder / "in");
  std::string manifest = "name,robot,measurements,test\n";
  for (std::size_t i = 0; i < count; ++i) {
    SimulationOptions options;
    options.seed = 1000 + i;
    options.configurations = poses;
    options.test_configurations = 10;
    const Simulation s = simulate(family_robot(family_names()[i % 2]), options);
    const std::string n = std::to_string(i + 1);
    write_bytes(folder / ("in/r" + n + ".toml"), write_robot(s.nominal));
    write_bytes(folder / ("in/m" + n + ".csv"), bad && i == 1 ? "q1,x\n1,2\n" : measurement_text(s.train, s.nominal));
    write_bytes(folder / ("in/t" + n + ".csv"), measurement_text(s.test, s.nominal));
    manifest += "unit " + n + ",r" + n + ".toml,m" + n + ".csv,t" + n + ".csv\n";
  }
  write_bytes(folder / "in/fleet.csv", manifest);
}

// Every file below a folder with its bytes.
std::map<std::string, std::string> contents(const std::string& folder) {
  std::map<std::string, std::string> files;
  if (!fs::exists(folder)) return files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) files[fs::relative(entry.path(), folder).string()] = read_bytes(entry.path().string());
  }
  return files;
}

TEST(Batch, CalibratesAllAndSummarizesThem) {
  const TemporaryFolder folder;
  write_fleet(folder, 4, 30, true);
  const auto run = run_mdhcal({"batch", folder / "in/fleet.csv", "-o", folder / "out", "-j", "2"});
  EXPECT_EQ(run.exit_code, 1) << run.err;  // one was refused
  EXPECT_EQ(run.out, "");
  EXPECT_NE(run.err.find("unit 2: "), std::string::npos) << run.err;
  const std::vector<std::string> names{"summary.csv", "summary.html", "unit 1", "unit 3", "unit 4"};
  EXPECT_EQ(names_in(folder / "out"), names);
  const std::string csv = read_bytes(folder / "out/summary.csv");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 5);
  EXPECT_NE(csv.find("\nunit 1,done,30,"), std::string::npos) << csv;
  EXPECT_NE(csv.find("\nunit 2,refused,"), std::string::npos) << csv;
  // The unit is what calibrate makes, without a report.
  const auto alone = run_mdhcal({"calibrate", folder / "in/r3.toml", folder / "in/m3.csv", "--test", folder / "in/t3.csv",
                                 "-o", folder / "alone"});
  ASSERT_EQ(alone.exit_code, 0) << alone.err;
  auto expected = contents(folder / "alone");
  expected.erase("report.html");
  EXPECT_EQ(contents(folder / "out/unit 3"), expected);
}

TEST(Batch, SlicesMakeTheSameFleetAndWhatIsDoneStays) {
  const TemporaryFolder folder;
  write_fleet(folder, 5, 25, false);
  ASSERT_EQ(run_mdhcal({"batch", folder / "in/fleet.csv", "-o", folder / "whole"}).exit_code, 0);
  for (const char* slice : {"1/3", "2/3", "3/3"}) {
    ASSERT_EQ(run_mdhcal({"batch", folder / "in/fleet.csv", "-o", folder / "parts", "--slice", slice}).exit_code, 0);
  }
  const auto again = run_mdhcal({"batch", folder / "in/fleet.csv", "-o", folder / "parts"});
  EXPECT_NE(again.err.find("0 calibrated, 5 were done before"), std::string::npos) << again.err;
  auto parts = contents(folder / "parts");
  for (const char* n : {"1", "2", "3"}) {
    EXPECT_EQ(parts.erase("summary-" + std::string(n) + "-of-3.csv"), 1u);
    EXPECT_EQ(parts.erase("summary-" + std::string(n) + "-of-3.html"), 1u);
  }
  EXPECT_EQ(parts, contents(folder / "whole"));
}

TEST(Batch, TakesTheOptionsOfCalibrateAndPrintsJson) {
  const TemporaryFolder folder;
  write_fleet(folder, 3, 25, true);
  const auto run = run_mdhcal({"batch", folder / "in/fleet.csv", "-o", folder / "out", "--fix", "a3", "--noise", "0.05", "--json"});
  EXPECT_EQ(run.exit_code, 1);
  const auto json = nlohmann::json::parse(run.out);
  ASSERT_EQ(json["robots"].size(), 3u);
  EXPECT_EQ(json["robots"][0]["state"], "calibrated");
  EXPECT_EQ(json["robots"][1]["state"], "refused");
  EXPECT_NE(json["robots"][1]["message"].get<std::string>().find("m2.csv"), std::string::npos);
  EXPECT_EQ(json["summary"], folder / "out/summary.csv");
  ASSERT_EQ(run_mdhcal({"calibrate", folder / "in/r1.toml", folder / "in/m1.csv", "--test", folder / "in/t1.csv", "--fix", "a3",
                        "--noise", "0.05", "-o", folder / "alone"}).exit_code, 0);
  EXPECT_EQ(read_bytes(folder / "out/unit 1/result.json"), read_bytes(folder / "alone/result.json"));
}

// The example of the help, under GNU parallel.
TEST(Batch, RunsUnderGnuParallel) {
  const TemporaryFolder folder;
  write_fleet(folder, 4, 25, false);
  ASSERT_EQ(run_mdhcal({"batch", folder / "in/fleet.csv", "-o", folder / "whole"}).exit_code, 0);
  const auto run = run_program("parallel", {"--will-cite", "-j2", MDHCAL_PROGRAM, "batch", folder / "in/fleet.csv", "-o",
                                            folder / "parts", "--slice", "{}/4", ":::", "1", "2", "3", "4"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  ASSERT_EQ(run_mdhcal({"batch", folder / "in/fleet.csv", "-o", folder / "parts"}).exit_code, 0);
  EXPECT_EQ(read_bytes(folder / "parts/summary.csv"), read_bytes(folder / "whole/summary.csv"));
}

// True if the process has begun to write a result beside its final place in `folder`: at least one file of it is there.
std::set<std::string> partials_in(const std::string& folder) {
  std::set<std::string> names;
  std::error_code gone;  // what is listed may be renamed meanwhile
  for (const auto& entry : fs::directory_iterator(folder, gone)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with('.') || name.find(".mdhcal-partial-") == std::string::npos) continue;
    if (fs::directory_iterator(entry.path(), gone) != fs::directory_iterator()) names.insert(name);
  }
  return names;
}

// Whether there is a part of a result beside those that earlier ones left.
bool is_writing(const std::string& folder, const std::set<std::string>& left) {
  for (const std::string& name : partials_in(folder)) {
    if (!left.contains(name)) return true;
  }
  return false;
}

struct Kill {
  bool cut = false;     // it was still running
  bool inside = false;  // and had written a part of a result
};

// Starts the program and kills it after that many microseconds, counted from its start or, if it `writes_in` there, from
// its first file in the folder.
Kill kill_after(const std::vector<std::string>& arguments, useconds_t after_us, const std::string& folder, bool writes_in) {
  std::vector<char*> argv;
  std::string program = MDHCAL_PROGRAM;
  argv.push_back(program.data());
  std::vector<std::string> copy = arguments;
  for (std::string& a : copy) argv.push_back(a.data());
  argv.push_back(nullptr);
  const std::set<std::string> left = partials_in(folder);
  const pid_t child = fork();
  if (child == 0) {
    setenv("SOURCE_DATE_EPOCH", "1767225600", 1);
    const int null = open("/dev/null", O_WRONLY);
    dup2(null, STDERR_FILENO);
    execv(argv[0], argv.data());
    _exit(127);
  }
  siginfo_t ended{};
  while (writes_in && !is_writing(folder, left)) {
    waitid(P_PID, static_cast<id_t>(child), &ended, WEXITED | WNOHANG | WNOWAIT);
    if (ended.si_pid == child) break;
    usleep(50);
  }
  usleep(after_us);
  kill(child, SIGKILL);
  int status = 0;
  waitpid(child, &status, 0);
  return {WIFSIGNALED(status), WIFSIGNALED(status) && is_writing(folder, left)};
}

double seconds_of(const std::vector<std::string>& arguments) {
  const auto start = std::chrono::steady_clock::now();
  EXPECT_EQ(run_mdhcal(arguments).exit_code, 0);
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

TEST(Kill, CalibrateLeavesNothingOrEverything) {
  const TemporaryFolder folder;
  write_fleet(folder, 1, 60, false);
  const std::vector<std::string> arguments{"calibrate", folder / "in/r1.toml", folder / "in/m1.csv", "-o", folder / "out/x"};
  // The least of three: one that something else held up would set all moments too late.
  double seconds = seconds_of(arguments);
  for (int k = 0; k < 2; ++k) seconds = std::min(seconds, seconds_of(arguments));
  const auto whole = contents(folder / "out/x");
  ASSERT_EQ(whole.size(), 5u);
  Random random(1);
  int cut = 0, inside = 0, nothing = 0;
  for (int k = 0; k < 50; ++k) {
    if (k % 2 == 0) fs::remove_all(folder / "out");  // every other time an earlier result is exchanged
    // Half of the moments lie anywhere, half where files are written.
    const bool writes_in = k % 4 >= 2;
    const double after_s = random.uniform(0, writes_in ? 0.7 * seconds : 1.1 * seconds);
    const Kill kill = kill_after(arguments, static_cast<useconds_t>(1e6 * after_s), folder / "out", writes_in);
    cut += kill.cut;
    inside += kill.inside;
    if (!fs::exists(folder / "out/x")) {
      ++nothing;
      continue;
    }
    EXPECT_EQ(contents(folder / "out/x"), whole) << k;
  }
  std::printf("%d of 50 killed, %d while a result was half written\n", cut, inside);
  EXPECT_GT(cut, 20);
  EXPECT_GT(inside, 12);
  EXPECT_GT(nothing, 5);
  seconds_of(arguments);
  EXPECT_EQ(names_in(folder / "out"), std::vector<std::string>{"x"});  // what the killed ones left is gone
}

TEST(Kill, ABatchIsContinuedWithoutLosingOrRedoingARobot) {
  const TemporaryFolder folder;
  write_fleet(folder, 6, 40, false);
  const auto arguments = [&](const std::string& out) {
    return std::vector<std::string>{"batch", folder / "in/fleet.csv", "-o", folder / out, "-j", "2"};
  };
  double seconds = seconds_of(arguments("whole"));
  const auto whole = contents(folder / "whole");
  ASSERT_EQ(whole.size(), 6u * 4 + 2);
  Random random(2);
  int cut = 0, inside = 0;
  std::map<std::string, fs::file_time_type> born;
  for (int k = 0; k < 50; ++k) {
    if (k % 5 == 0) {
      fs::remove_all(folder / "out");
      born.clear();
    }
    const bool writes_in = k % 2 == 1;
    const double after_s = writes_in ? random.uniform(0, 0.002) : random.uniform(0, 0.9 * seconds);
    const Kill kill = kill_after(arguments("out"), static_cast<useconds_t>(1e6 * after_s), folder / "out", writes_in);
    cut += kill.cut;
    inside += kill.inside;
    // A fleet that was done in less was measured on a machine busy with something else.
    if (k % 5 == 0 && !kill.cut) seconds *= 0.7;
    if (!fs::exists(folder / "out")) continue;
    for (const std::string& name : names_in(folder / "out")) {
      if (name[0] == '.' || name.starts_with("summary")) continue;
      const auto unit = contents(folder / ("out/" + name));
      EXPECT_EQ(unit.size(), 4u) << name;
      for (const auto& [file, bytes] : unit) EXPECT_EQ(bytes, whole.at(name + '/' + file));
      const auto time = fs::last_write_time(folder / ("out/" + name + "/result.json"));
      EXPECT_EQ(born.emplace(name, time).first->second, time) << name << " was done twice";
    }
  }
  std::printf("%d of 50 killed, %d while a result was half written\n", cut, inside);
  EXPECT_GT(cut, 20);
  EXPECT_GT(inside, 12);
  ASSERT_EQ(run_mdhcal(arguments("out")).exit_code, 0);
  EXPECT_EQ(contents(folder / "out"), whole);
}

TEST(Manifest, MalformedOnesAreRefusedWithTheirSpot) {
  const TemporaryFolder folder;
  const auto message = [&](const std::string& text) -> std::string {
    write_bytes(folder / "m.csv", text);
    try {
      (void)read_manifest(folder / "m.csv");
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_NE(message("name,robot\na,b\n").find("measurements"), std::string::npos);
  EXPECT_NE(message("name,robot,measurements\na,r,m\na,r,m\n").find("m.csv:3:1"), std::string::npos);
  EXPECT_NE(message("name,robot,measurements\n../a,r,m\n").find("m.csv:2:1"), std::string::npos);
  EXPECT_NE(message("name,robot,measurements\n.a,r,m\n").find("m.csv:2:1"), std::string::npos);
  EXPECT_NE(message("name,robot,measurements\na,,m\n").find("m.csv:2:3"), std::string::npos);
  EXPECT_NE(message("name,robot,measurements\n").find("no rows"), std::string::npos);
  for (const char* slice : {"0/3", "4/3", "1", "1/", "a/b", "1/2x"}) {
    write_bytes(folder / "m.csv", "name,robot,measurements\na,r,m\n");
    EXPECT_EQ(run_mdhcal({"batch", folder / "m.csv", "-o", folder / "out", "--slice", slice}).exit_code, 2) << slice;
  }
  EXPECT_FALSE(fs::exists(folder / "out"));
}

}  // namespace
