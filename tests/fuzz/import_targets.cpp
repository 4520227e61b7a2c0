// SPDX-License-Identifier: MIT
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "offline/base/error.hpp"
#include "offline/import/join.hpp"
#include "offline/import/program.hpp"
#include "offline/import/rows.hpp"
#include "tests/fuzz/targets.hpp"

namespace mdhcal::fuzz {

namespace {

using offline::InputError;

[[noreturn]] void stop_import(const char* what) {
  std::fprintf(stderr, "broken: %s\n", what);
  std::abort();
}

const offline::Robot& six_joint_robot() {
  static const offline::Robot robot = [] {
    offline::Robot six;
    six.geometry.joint_count = 6;
    for (std::size_t i = 0; i < 6; ++i) six.geometry.joint[i].sign = 1;
    six.geometry.last_T_flange.quaternion[0] = 1.0;
    return six;
  }();
  return robot;
}

void check_rows(const offline::SourceTable& table) {
  for (const offline::SourceRow& row : table.rows) {
    if (row.index >= table.row_count) stop_import("a row's number is within its file");
    if (row.position_m) {
      for (const double p : *row.position_m) {
        if (!(std::abs(p) <= 1e6)) stop_import("a point is finite");
      }
    }
    if (row.joints) {
      for (const double q : *row.joints) {
        if (!std::isfinite(q)) stop_import("joints are finite");
      }
    }
    if (row.quaternion) {
      double norm = 0;
      for (const double q : *row.quaternion) norm += q * q;
      if (!(std::abs(norm - 1) <= 1e-9)) stop_import("a rotation is a unit quaternion");
    }
  }
}

}  // namespace

void source_target(const std::uint8_t* data, std::size_t size) {
  const std::string bytes(data, data + size);
  offline::Profile stated;
  // Without --rotation most tables with angles end in a question.
  stated.rotation = (size & 1U) != 0U ? "kuka" : "";
  try {
    const offline::SourceTable table = offline::read_source(bytes, "fuzz", stated, six_joint_robot(), {});
    check_rows(table);
    const bool whole = table.measures && table.has_joints;
    (void)offline::join({table}, whole ? nullptr : &table, six_joint_robot(), {}, {});
  } catch (const InputError&) {
    return;
  }
}

void program_target(const std::uint8_t* data, std::size_t size) {
  const std::string text(data, data + size);
  using offline::ProgramLanguage;
  for (const ProgramLanguage language : {ProgramLanguage::krl, ProgramLanguage::rapid, ProgramLanguage::fanuc_ls, ProgramLanguage::inform,
                                         ProgramLanguage::urscript, ProgramLanguage::val3, ProgramLanguage::joint_state}) {
    try {
      for (const offline::ProgramPosition& position : offline::read_program(text, language, "fuzz")) {
        if (position.numbers.empty()) stop_import("a position has numbers");
        for (const offline::ProgramNumber& number : position.numbers) {
          if (number.begin > number.end || number.end > text.size()) stop_import("a number lies in the text");
          if (number.begin == number.end) continue;
          const std::string written = text.substr(number.begin, number.end - number.begin);
          char* end = nullptr;
          if (std::abs(std::strtod(written.c_str(), &end) - number.value) > 0 || *end != 0) stop_import("a number's bytes are the number");
        }
      }
    } catch (const InputError&) {
      continue;
    }
  }
}

void profile_target(const std::uint8_t* data, std::size_t size) {
  try {
    const offline::Profile profile = offline::parse_profile(std::string(data, data + size), "fuzz.toml", "fuzz");
    (void)offline::read_source("# n x y z\nP::1::A,1.5,2.5,3.5,4.5,5.5,6.5\nP::2::A,7.5,8.5,9.5,1.5,2.5,3.5\n", "table", profile, six_joint_robot(), {});
  } catch (const InputError&) {
    return;
  }
}

}  // namespace mdhcal::fuzz
