// SPDX-License-Identifier: MIT
// FANUC: P[1]{ GP1: UF : 1, UT : 1, CONFIG : 'N U T, 0, 0, 0', X = ... }; the moves stand in /MN.
#include "offline/filter/target_text.hpp"
#include "offline/import/scanner.hpp"

namespace mdhcal::offline {

namespace {

void read_config(Scanner& s, ProgramTarget& target) {
  s.skip_spaces();
  s.expect(':');
  s.skip_spaces();
  s.expect('\'');
  s.skip_spaces();
  while (!s.done() && s.peek() != ',' && s.peek() != '\'') {
    switch (s.peek()) {
      case 'F': case 'N':
        target.letter = s.at();
        target.stated.reading[4] = s.peek() == 'F' ? wrist_negative : wrist_positive;
        break;
      case 'U': case 'D': target.stated.lower = s.peek() == 'D'; break;
      case 'T': case 'B': target.stated.rear = s.peek() == 'B'; break;
      case ' ': case 'L': case 'R': break;
      default: s.fail(std::string("Found '") + s.peek() + "' in a CONFIG; expected F or N, U or D, T or B.");
    }
    s.next();
  }
  constexpr std::int32_t joints[3] = {0, 3, 5};
  for (std::size_t k = 0; k < 3 && s.peek() == ','; ++k) {
    s.next();
    s.skip_spaces();
    const ProgramNumber turn = s.number();
    s.skip_spaces();
    target.flags.push_back({turn, joints[k]});
    target.stated.reading[static_cast<std::size_t>(joints[k])] = {(turn.value - 0.5) * one_turn_rad, (turn.value + 0.5) * one_turn_rad};
  }
  s.expect('\'');
}

// What of a position's first group is beside its numbers.
void read_group(Scanner& s, ProgramTarget& target) {
  s.go(target.position.begin);
  while (!s.done() && s.peek() != '{') s.peek() == '"' ? s.skip_string() : static_cast<void>(s.next());
  while (!s.done() && s.at() < target.position.numbers[0].begin) {
    const std::string_view key = s.name();
    if (key.empty()) {
      s.next();
    } else if (key == "UF" || key == "UT") {
      s.skip_spaces();
      s.expect(':');
      s.skip_spaces();
      if (s.peek() == 'F') s.fail("Found the frame or tool 'F' (that which is chosen when the program runs); expected a number.");
      (key == "UF" ? target.frame : target.tool) = number_name(s.number());
    } else if (key == "CONFIG") {
      read_config(s, target);
    }
  }
}

std::optional<std::string> point_here(Scanner& s) {
  if (!s.take("P[")) return {};
  std::string name(s.name());
  s.skip_line();
  return name;
}

}  // namespace

TargetText fanuc_ls_targets(std::string_view text, const std::string& path) {
  TargetText out;
  out.language = ProgramLanguage::fanuc_ls;
  std::map<std::string, std::size_t> number;
  for (ProgramPosition& position : read_fanuc_ls(text, path)) {
    ProgramTarget target;
    target.position = std::move(position);
    Scanner s(text, path);
    read_group(s, target);
    number[target.position.name] = out.targets.size();
    out.targets.push_back(std::move(target));
  }
  // "  5:L P[2] 50mm/sec FINE    ;", a circle's end on the next line behind ':'.
  Scanner s(text, path);
  bool in_moves = false;
  while (!s.done()) {
    s.skip_spaces();
    if (s.looks_at("/")) {
      in_moves = s.looks_at("/MN");
      s.skip_line();
      continue;
    }
    const std::size_t line = s.at();
    const bool numbered = s.at_number();
    if (numbered) (void)s.name();
    if (!in_moves || s.peek() != ':') {
      s.skip_line();
      continue;
    }
    s.next();
    const char kind = s.peek();
    const bool goes_on = kind == ' ' || kind == '\t';  // the second point of a circle
    if (!goes_on) {
      if ((kind != 'J' && kind != 'L' && kind != 'C' && kind != 'A')) {
        s.skip_line();
        continue;
      }
      s.next();
      if (s.peek() != ' ') {
        s.skip_line();
        continue;
      }
    }
    s.skip_spaces();
    const std::size_t at = s.at();
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view rest = text.substr(at, end - at);
    if (rest.starts_with("PR[")) {
      out.left_out.push_back({at, "is a position register"});
      out.moves.push_back({MoveKind::joint, line, {}});
    } else if (const auto name = point_here(s); name && number.count(*name) != 0) {
      if (rest.find("PR[") != std::string_view::npos) out.left_out.push_back({at, "is moved by a position register"});
      const bool offset = rest.find("PR[") != std::string_view::npos;
      if (goes_on && !out.moves.empty() && out.moves.back().kind == MoveKind::circle) {
        out.moves.back().targets.push_back(number[*name]);
      } else {
        const MoveKind how = kind == 'L' ? MoveKind::line : kind == 'J' ? MoveKind::joint : MoveKind::circle;
        out.moves.push_back({how, line, {}});
        if (!offset) out.moves.back().targets.push_back(number[*name]);
      }
      continue;
    }
    s.skip_line();
  }
  return out;
}

}  // namespace mdhcal::offline
