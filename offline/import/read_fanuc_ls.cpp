// SPDX-License-Identifier: MIT
// FANUC: /POS, then P[1:"comment"]{ GP1: UF : 0, UT : 1, J1= 1.500 deg, ... }; with X, Y, Z, W, P, R instead of joints.
#include <array>

#include "offline/import/scanner.hpp"

namespace mdhcal::offline {

namespace {

constexpr std::array<std::string_view, 6> pose_keys{"X", "Y", "Z", "W", "P", "R"};

// The record between the braces; the first motion group only, others are positioners.
ProgramPosition record(Scanner& s, std::size_t begin) {
  ProgramPosition position;
  position.begin = begin;
  std::array<ProgramNumber, 9> joints{}, pose{};
  bool first_group = true;
  while (!s.done() && s.peek() != '}') {
    if (s.peek() == '\'' || s.peek() == '"') {
      s.skip_string();
      continue;
    }
    const std::string_view key = s.name();
    if (key.empty()) {
      s.next();
      continue;
    }
    if (key.size() == 3 && key.starts_with("GP")) first_group = key == "GP1";
    s.skip_spaces();
    if (s.peek() != '=') continue;
    s.next();
    s.skip_spaces();
    const bool joint = key.size() == 2 && key[0] == 'J' && key[1] >= '1' && key[1] <= '9';
    std::size_t p = 0;
    while (p < pose_keys.size() && key != pose_keys[p]) ++p;
    if (!first_group || (!joint && p == pose_keys.size())) continue;
    if (s.looks_at("*")) s.fail("Found a position that was never taught (asterisks); expected a number.");
    const ProgramNumber number = s.number();
    if (joint) {
      joints[static_cast<std::size_t>(key[1] - '1')] = number;
    } else {
      pose[p] = number;
    }
  }
  if (s.done()) s.fail_at(begin, "Found a position that is not closed; expected \"};\".");
  s.next();
  if (joints[0].end != 0) {
    bool ended = false;
    for (const ProgramNumber& joint : joints) {
      if (joint.end != 0 && ended) s.fail_at(begin, "Found a position in which a joint is left out; expected J1, J2 and so on.");
      ended = joint.end == 0;
      if (!ended) position.numbers.push_back(joint);
    }
    return position;
  }
  position.kind = ProgramPositionKind::pose;
  for (std::size_t k = 0; k < pose_keys.size(); ++k) {
    if (pose[k].end == 0) s.fail_at(begin, "Found a position without " + std::string(pose_keys[k]) + "; expected J1 to J6, or X, Y, Z, W, P, R.");
    position.numbers.push_back(pose[k]);
  }
  return position;
}

}  // namespace

std::vector<ProgramPosition> read_fanuc_ls(std::string_view text, const std::string& path) {
  std::vector<ProgramPosition> positions;
  Scanner s(text, path);
  bool in_positions = false;
  while (!s.done()) {
    s.skip_spaces();
    if (!in_positions) {
      in_positions = s.looks_at("/POS");
      s.skip_line();
      continue;
    }
    const std::size_t begin = s.at();
    if (!s.take("P[")) {
      s.skip_line();
      continue;
    }
    const std::string number(s.name());
    while (!s.done() && s.peek() != ']' && s.peek() != '\n') {
      if (s.peek() == '"') {
        s.skip_string();
      } else {
        s.next();
      }
    }
    s.expect(']');
    s.skip_blanks();
    s.expect('{');
    ProgramPosition position = record(s, begin);
    position.name = number;
    positions.push_back(std::move(position));
  }
  return positions;
}

}  // namespace mdhcal::offline
