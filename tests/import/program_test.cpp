// SPDX-License-Identifier: MIT
// Robot programs written here by hand in each language: what is read, and that every number's bytes are where they are said to be.
#include <cstdlib>

#include <gtest/gtest.h>

#include "offline/base/error.hpp"
#include "offline/import/program.hpp"

namespace {

using namespace mdhcal::offline;

struct Expected {
  const char* name;
  ProgramPositionKind kind;
  std::vector<double> numbers;
};

struct Program {
  ProgramLanguage language;
  const char* text;
  std::vector<Expected> positions;
};

constexpr auto joints = ProgramPositionKind::joints;
constexpr auto pulses = ProgramPositionKind::pulses;
constexpr auto pose = ProgramPositionKind::pose;

const std::vector<Program>& programs() {
  static const std::vector<Program> all{
      {ProgramLanguage::krl,
       "&ACCESS RVP\nDEFDAT  CAL\n;DECL E6AXIS XOLD={A1 9,A2 9,A3 9,A4 9,A5 9,A6 9}\n"
       "DECL E6AXIS XP1={A1 -1.5,A2 2,A3 3.25,A4 4,A5 5,A6 6,E1 0.0,E2 0.0}\r\n"
       "DECL FDAT FP1={TOOL_NO 1,BASE_NO 0,POINT2[] \"XP2={A1 1\"}\n"
       "E6POS XP2={X 1.0,Y 2.0,Z 3.0,A 10.0,B 20.0,C 30.0,S 2,T 4,E1 0.0}\n"
       "TAB[3]={E6AXIS: A1 1,A2 2,A3 3,A4 4,A5 5,A6 6}\nPTP {A1 0,A2 -90,A3 90,A4 0,A5 1E1,A6 0}\nENDDAT\n",
       {{"P1", joints, {-1.5, 2, 3.25, 4, 5, 6, 0, 0}},
        {"P2", pose, {1, 2, 3, 10, 20, 30}},
        {"TAB[3]", joints, {1, 2, 3, 4, 5, 6}},
        {"", joints, {0, -90, 90, 0, 10, 0}}}},
      {ProgramLanguage::rapid,
       "MODULE Cal\n ! jointtarget old:=[[9,9,9,9,9,9],[9E9,9E9,9E9,9E9,9E9,9E9]];\n"
       " CONST jointtarget jA:=[[1,-2.5,3,\n  4,5,6],[7.5,9E+09,9E9,9E9,9E9,9E9]];\n"
       " LOCAL PERS robtarget pB:=[[1,2,3],[1,0,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];\n"
       " VAR jointtarget jC{2}:=[[[1,2,3,4,5,6],[9E9,9E9,9E9,9E9,9E9,9E9]],[[6,5,4,3,2,1],[9E9,9E9,9E9,9E9,9E9,9E9]]];\n"
       " VAR jointtarget jEmpty;\n TPWrite \"jointtarget jX:=[[1\";\n PROC p(jointtarget a)\n ENDPROC\nENDMODULE\n",
       {{"jA", joints, {1, -2.5, 3, 4, 5, 6, 7.5}},
        {"pB", pose, {1, 2, 3, 1, 0, 0, 0}},
        {"jC{1}", joints, {1, 2, 3, 4, 5, 6}},
        {"jC{2}", joints, {6, 5, 4, 3, 2, 1}}}},
      {ProgramLanguage::fanuc_ls,
       "/PROG  CAL\n/MN\n   1:J P[1] 10% FINE ;\n/POS\nP[1:\"a J1= 9 deg\"]{\n   GP1:\n\tUF : 0, UT : 1,\n\tJ1=  -1.500 deg,\tJ2= 2.000 deg,\tJ3= 3 deg,\n"
       "\tJ4= 4 deg, J5= 5 deg, J6= 6 deg\n   GP2:\n\tUF : 0, UT : 1,\n\tJ1= 90.0 deg\n};\n"
       "P[2]{\n   GP1:\n\tUF : 0, UT : 1, CONFIG : 'N U T, 0, 0, 0',\n\tX = 1 mm, Y = 2 mm, Z = 3 mm,\n\tW = 4 deg, P = 5 deg, R = 6 deg\n};\n/END\n",
       {{"1", joints, {-1.5, 2, 3, 4, 5, 6}}, {"2", pose, {1, 2, 3, 4, 5, 6}}}},
      {ProgramLanguage::inform,
       "/JOB\n//NAME CAL\n//POS\n///NPOS 3,0,0,0,0,0\n///TOOL 0\n///POSTYPE PULSE\n///PULSE\nC00000=100,-200,300,0,0,6\n"
       "///RECTAN\nC00001=1.5,2,3,4,5,6\n///ANGLE\nC00002=1,2,3,4,5,6\n//INST\nC00003=9,9,9,9,9,9\nEND\n",
       {{"C00000", pulses, {100, -200, 300, 0, 0, 6}}, {"C00001", pose, {1.5, 2, 3, 4, 5, 6}}, {"C00002", joints, {1, 2, 3, 4, 5, 6}}}},
      {ProgramLanguage::urscript,
       "def cal():\n  set_tcp(p[0,0,0.1,0,0,0])\n  # P1\n  movej([0.1, -0.2, 0.3, 0.4, 0.5, 6e-1], a=1.2, v=0.5)\n"
       "  home = [1,2,3,4,5,6]\n  textmsg(\"movej([9,9,9,9,9,9])\")\n  movel(p[0.1,0.2,0.3,0,0,1.5], v=0.1)\n  movej(get_inverse_kin(p[9,9,9,9,9,9], qnear=[9,9,9,9,9,9]))\nend\n",
       {{"P1", joints, {0.1, -0.2, 0.3, 0.4, 0.5, 0.6}}, {"home", joints, {1, 2, 3, 4, 5, 6}}, {"3", pose, {0.1, 0.2, 0.3, 0, 0, 1.5}}}},
      {ProgramLanguage::val3,
       "<?xml version=\"1.0\"?>\n<Database>\n <!-- <Value key=\"9\" j1=\"9\"/> -->\n <Datas>\n  <Data name=\"jA\" type=\"jointRx\" size=\"2\">\n"
       "   <Value key=\"0\" j1=\"1.5\" j2=\"-2\" j3=\"3\" j4=\"4\" j5=\"5\" j6=\"6\" />\n   <Value key=\"1\" j6=\"7\" />\n  </Data>\n"
       "  <Data name=\"n\" type=\"num\"><Value key=\"0\" value=\"3\"/></Data>\n  <Data name=\"pB\" type=\"pointRx\"><Value key=\"0\" x=\"1\" rx=\"2\"/></Data>\n </Datas>\n</Database>\n",
       {{"jA[0]", joints, {1.5, -2, 3, 4, 5, 6}}, {"jA[1]", joints, {0, 0, 0, 0, 0, 7}}, {"pB[0]", pose, {1, 0, 0, 2, 0, 0}}}},
      {ProgramLanguage::joint_state,
       "header:\n  stamp:\n    sec: 10\n    nanosec: 500000000\n  frame_id: ''\nname:\n- elbow\n- 'wrist'\nposition:\n- 0.5\n- -1e-1\nvelocity: []\n---\n"
       "header:\n  stamp:\n    sec: 11\n    nanosec: 0\nname: [elbow, \"wrist\"]\nposition: [1.5,\n  2.5]\n---\n",
       {{"1", joints, {0.5, -0.1}}, {"2", joints, {1.5, 2.5}}}}};
  return all;
}

TEST(Programs, GiveTheirPositionsWithTheBytesOfEachNumber) {
  for (const Program& program : programs()) {
    SCOPED_TRACE(language_name(program.language));
    const std::string_view text = program.text;
    ASSERT_EQ(program_language(text), program.language);
    const auto positions = read_program(text, program.language, "program");
    ASSERT_EQ(positions.size(), program.positions.size());
    std::size_t behind = 0;
    for (std::size_t i = 0; i < positions.size(); ++i) {
      EXPECT_EQ(positions[i].name, program.positions[i].name);
      EXPECT_EQ(positions[i].kind, program.positions[i].kind);
      ASSERT_EQ(positions[i].numbers.size(), program.positions[i].numbers.size()) << positions[i].name;
      for (std::size_t k = 0; k < positions[i].numbers.size(); ++k) {
        const ProgramNumber& number = positions[i].numbers[k];
        EXPECT_EQ(number.value, program.positions[i].numbers[k]) << positions[i].name << ' ' << k;
        if (number.end == number.begin) continue;  // left out in the text
        // The bytes are the number and nothing else, and follow each other.
        const std::string bytes(text.substr(number.begin, number.end - number.begin));
        char* end = nullptr;
        EXPECT_EQ(std::strtod(bytes.c_str(), &end), number.value);
        EXPECT_EQ(*end, 0) << bytes;
        EXPECT_GE(number.begin, behind);
        behind = number.end;
      }
    }
  }
}

TEST(Programs, JointStatesHaveTheirNamesAndTime) {
  const Program& program = programs().back();
  const auto positions = read_program(program.text, program.language, "p");
  EXPECT_EQ(positions[0].joint_names, (std::vector<std::string>{"elbow", "wrist"}));
  EXPECT_EQ(positions[1].joint_names, (std::vector<std::string>{"elbow", "wrist"}));
  EXPECT_EQ(positions[0].time_s, 10.5);
  EXPECT_EQ(positions[1].time_s, 11.0);
}

// Cut anywhere, a program is read as far as it goes or refused with a place; nothing else happens.
TEST(Programs, CutAnywhereAreReadOrRefused) {
  for (const Program& program : programs()) {
    const std::string text = program.text;
    for (std::size_t cut = 0; cut <= text.size(); ++cut) {
      try {
        const auto positions = read_program(std::string_view(text).substr(0, cut), program.language, "cut");
        EXPECT_LE(positions.size(), program.positions.size());
      } catch (const InputError& error) {
        EXPECT_TRUE(std::string(error.what()).starts_with("cut:")) << error.what();
      }
    }
  }
}

TEST(Programs, WhatIsNoNumberIsRefusedWithItsPlace) {
  const auto refused = [](ProgramLanguage language, const char* text) {
    try {
      (void)read_program(text, language, "p");
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(refused(ProgramLanguage::fanuc_ls, "/POS\nP[1]{\n GP1:\n J1= ****** deg\n};").find("p:4:6: Found a position that was never taught"), std::string::npos);
  EXPECT_NE(refused(ProgramLanguage::fanuc_ls, "/POS\nP[1]{\n GP1:\n J1= 1 deg, J3= 2 deg\n};").find("p:2:1: "), std::string::npos);
  EXPECT_NE(refused(ProgramLanguage::val3, "<Data name=\"a\" type=\"jointRx\"><Value j1=\"1x\"/>").find("p:1:"), std::string::npos);
  EXPECT_NE(refused(ProgramLanguage::inform, "//POS\n///PULSE\nC00000=1,,2\n").find("p:3:"), std::string::npos);
  EXPECT_NE(refused(ProgramLanguage::krl, "E6AXIS P={A1 1,A3 3}").find("without A2"), std::string::npos);
  EXPECT_NE(refused(ProgramLanguage::joint_state, "name:\n- a\nposition:\n- 1\n- 2\n").find("Found 2 positions and 1 names"), std::string::npos);
}

TEST(Programs, TablesAreNone) {
  for (const char* text : {"id,x_mm,y_mm,z_mm\nP1,1,2,3\n", "A1;A2;A3\n1;2;3\n", "", "name,position\n"}) {
    EXPECT_FALSE(program_language(text).has_value()) << text;
  }
}

}  // namespace
