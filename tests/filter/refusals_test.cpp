// SPDX-License-Identifier: MIT
// Programs that are broken, ambiguous or out of reach: named by file, line and column, and never half written.
#include <gtest/gtest.h>

#include "tests/support/program.hpp"

namespace {

using namespace mdhcal::tests;

// A spherical wrist, half a degree off in axis 2; joint 1 ends at 170 degrees.
const char* const arm =
    "name = \"a\"\n[[link]]\nalpha = 0\na = 0\nd = 400\ntheta = 0\nmin = -170\nmax = 170\n"
    "[[link]]\nalpha = -89.5\na = 100\nd = 0\ntheta = -90\nnominal = {alpha = -90, a = 100, d = 0, theta = -90, beta = 0}\n"
    "[[link]]\nalpha = 0\na = 500\nd = 0\ntheta = 0\n[[link]]\nalpha = -90\na = 90\nd = 550\ntheta = 0\n"
    "[[link]]\nalpha = 90\na = 0\nd = 0\ntheta = 0\n[[link]]\nalpha = -90\na = 0\nd = 90\ntheta = 0\n";

const std::string krl_head = "DEFDAT T\nDECL FDAT FP1={TOOL_NO 1,BASE_NO 0}\n";
const std::string krl_point = "DECL E6POS XP1={X 700.0000,Y 100.0000,Z 500.0000,A 0.0000,B 90.0000,C 0.0000,S 2,T 32}\n";
const std::string frames = "TOOL_DATA[1]={X 0,Y 0,Z 100,A 0,B 0,C 0}\n";

struct Job {
  Job() { write_bytes(folder / "arm.toml", arm), pack = run_mdhcal({"pack", folder / "arm.toml", "-o", folder / "arm.blob"}); }
  Outcome filter(const std::string& program, std::vector<std::string> more = {}) {
    EXPECT_EQ(pack.exit_code, 0) << pack.err;
    write_bytes(folder / "p", program);
    write_bytes(folder / "frames", frames);
    std::vector<std::string> arguments{"filter", folder / "p", folder / "arm.blob", "-o", folder / "out"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_mdhcal(arguments);
  }
  // Exit status, words in the message, and no output.
  void expect_refused(const std::string& program, int status, const std::string& words, std::vector<std::string> more = {}) {
    if (more.empty()) more = {"--frames", folder / "frames"};
    const Outcome run = filter(program, more);
    EXPECT_EQ(run.exit_code, status) << run.err;
    EXPECT_NE(run.err.find(words), std::string::npos) << run.err;
    EXPECT_EQ(names_in(folder.path()), (std::vector<std::string>{"arm.blob", "arm.toml", "frames", "p"}));
  }
  TemporaryFolder folder;
  Outcome pack;
};

std::string replaced(std::string text, const std::string& a, const std::string& b) {
  EXPECT_NE(text.find(a), std::string::npos) << a;
  return text.replace(text.find(a), a.size(), b);
}

TEST(FilterRefusals, PlacesAreNamed) {
  Job job;
  job.expect_refused("hello\n", 2, "Found no positions of a robot program");
  job.expect_refused(krl_head + replaced(krl_point, "S 2", "S 2.5"), 2, "p:3:80: Found a status S that is no whole number");
  job.expect_refused(krl_head + replaced(krl_point, "A 0.0000", "A 1e999"), 2, "p:3:52: Found a number that is too large");
  job.expect_refused("/PROG T\n/MN\n/POS\nP[1]{\n GP1:\n UF : 1, UT : 1, CONFIG : 'N X T, 0, 0, 0',\n X = 1 mm, Y = 2 mm, Z = 3 mm,\n W = 1 deg, P = 2 deg, R = 3 deg\n};\n/END\n", 2,
                     "p:6:30: Found 'X' in a CONFIG");
  job.expect_refused("/PROG T\n/MN\n/POS\nP[1]{\n GP1:\n UF : 1, UT : 1, CONFIG : 'N U T, 0, 0, 0',\n X = 1 mm", 2, "p:4:1: Found a position that is not closed");
  job.expect_refused("MODULE M\nCONST robtarget p:=[[1,2,3],[1,0,0,0],[0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];\nENDMODULE\n", 2, "p:2:45: Expected ','");
  job.expect_refused("/JOB\n//POS\n///POSTYPE PULSE\n///RECTAN\nC0=1,2,3,4,5,6\n//INST\n", 2, "p:5:1: Found a Cartesian position under ///POSTYPE PULSE");
  job.expect_refused("/JOB\n//POS\n///PULSE\nC0=1,2,3,4,5,6\n//INST\n", 2, "p:4:1: Target C0 is in pulses; expected a line \"pulses per degree");
  job.expect_refused("def t():\n  movej([0,0,0,0,1,0])\n  movel(p[0.7,0.1,0.5,0,0,0])\nend\n", 2, "p:3:9: Found no tool for target in line 3; expected it in --frames FILE, or --tool");
}

TEST(FilterRefusals, FramesAreAskedFor) {
  Job job;
  job.filter(krl_head + krl_point, {"--frames", job.folder / "frames"});
  EXPECT_EQ(run_program("rm", {job.folder / "out"}).exit_code, 0);
  job.expect_refused(replaced(krl_head, "TOOL_NO 1", "TOOL_NO 3") + krl_point, 2, "p:3:16: Found no pose of tool 3 of target P1; expected it in --frames FILE");
  job.expect_refused(krl_head + krl_point, 2, "Found 5 numbers; expected 6", {"--tool", "1,2,3,4,5"});
  const std::string rapid = "MODULE M\nPERS wobjdata w:=[FALSE,FALSE,\"track\",[[1,2,3],[1,0,0,0]],[[0,0,0],[1,0,0,0]]];\n"
                            "CONST robtarget p:=[[700,0,500],[0,0,1,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];\nPROC main()\nMoveL p,v5,fine,tool0\\WObj:=w;\nENDPROC\nENDMODULE\n";
  job.expect_refused(rapid, 2, "p:3:20: Target p stands in frame w, whose pose is not known: its user frame is moved by a mechanical unit", {"--controller", "nominal"});
}

TEST(FilterRefusals, WhatCannotBeMetStopsTheFilter) {
  Job job;
  job.expect_refused(krl_head + replaced(krl_point, "X 700", "X 7000"), 1, "p:3: target P1: the nominal arm does not reach it");
  // Wrist, elbow and turns fit no solution together.
  job.expect_refused(krl_head + replaced(krl_point, "T 32", "T 33"), 1, "no joints were found that meet it in its configuration");
  job.expect_refused("DEFDAT T\nDECL E6AXIS XH={A1 169.99,A2 0.0,A3 0.0,A4 0.0,A5 60.0,A6 0.0}\nDECL E6AXIS XG={A1 171.0,A2 0.0,A3 0.0,A4 0.0,A5 60.0,A6 0.0}\n", 1,
                     "target G: the arm as it is does not reach it");
}

TEST(FilterRefusals, TheProgramIsNeverWrittenOver) {
  Job job;
  write_bytes(job.folder / "p", krl_head + krl_point);
  write_bytes(job.folder / "frames", frames);
  const Outcome run = run_mdhcal({"filter", job.folder / "p", job.folder / "arm.blob", "--frames", job.folder / "frames", "-o", job.folder / "p"});
  EXPECT_EQ(run.exit_code, 2) << run.err;
  EXPECT_EQ(read_bytes(job.folder / "p"), krl_head + krl_point);
}

// Near the wrist's singularity the correction turns joints 4 and 6 against each other.
TEST(FilterReport, SingularTargetsAndLongLinesAreNamed) {
  Job job;
  const std::string program = "def t():\n  set_tcp(p[0,0,0.1,0,0,0])\n  movej([0,0,0,0,0.02,0])\n  movej([0,0.2,0,0,1,0])\n"
                              "  movel(p[0.7,-0.5,0.5,0,3.1,0])\n  movel(p[0.7,0.5,0.5,0,3.1,0])\n  movel(p[0.7,0.49,0.5,0,3.1,0])\nend\n";
  const Outcome run = job.filter(program, {"--controller", "nominal"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.err.find("p:3: target in line 3 is near a singularity: the correction turns joint "), std::string::npos) << run.err;
  EXPECT_EQ(run.err.find("p:4: target"), std::string::npos) << run.err;
  EXPECT_NE(run.err.find("p:6: the line to target in line 6, 1000 mm long, is off its straight by "), std::string::npos) << run.err;
  EXPECT_EQ(run.err.find("p:7: the line"), std::string::npos) << run.err;
  // "0" is written with the digits that it takes.
  EXPECT_EQ(read_bytes(job.folder / "out").find(",0,3.1"), std::string::npos);
}

// A configuration that changes gets a state line of its own, and the next record its own again. Joint 6 is at 179.8 degrees, and the
// correction turns it on by half a degree.
TEST(FilterReport, AChangedRconfStandsBeforeItsRecordAlone) {
  Job job;
  write_bytes(job.folder / "frames", "TOOL 0: X 0 Y 0 Z 100 Rx 0 Ry 0 Rz 0\n");
  const std::string state = "///RCONF 1,0,0,0,0,0,0,0\r\n", beyond = "///RCONF 1,0,0,0,1,0,0,0\r\n";
  const std::string begin = "/JOB\r\n//NAME T\r\n//POS\r\n///POSTYPE ROBOT\r\n///TOOL 0\r\n///RECTAN\r\n" + state;
  const std::string end = "//INST\r\nMOVL C00000\r\nMOVL C00001\r\n";
  write_bytes(job.folder / "p", begin + "C00000=796.789,140.495,706.988,-179.9272,19.9999,-169.7872\r\nC00001=804.552,156.427,682.667,178.1498,18.4993,-162.1165\r\n" + end);
  const Outcome run = run_mdhcal({"filter", job.folder / "p", job.folder / "arm.blob", "--frames", job.folder / "frames", "-o", job.folder / "out"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const std::string out = read_bytes(job.folder / "out");
  EXPECT_EQ(out.substr(0, begin.size() + beyond.size() + 7), begin + beyond + "C00000=") << out;
  const std::size_t second = out.find("C00001=");
  ASSERT_NE(second, std::string::npos);
  EXPECT_EQ(out.substr(second - state.size() - 2, state.size() + 2), "\r\n" + state) << out;
  EXPECT_EQ(out.substr(out.find("//INST")), end);
}

}  // namespace
