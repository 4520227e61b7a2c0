// SPDX-License-Identifier: MIT
// Yaskawa: state lines (///TOOL 1, ///USER 1, ///POSTYPE USER, ///RECTAN, ///RCONF 1,0,0,...) hold for the records behind them.
#include "offline/filter/target_text.hpp"
#include "offline/import/scanner.hpp"

namespace mdhcal::offline {

namespace {

// The state that the lines so far have set.
struct InformState {
  std::string tool = "0", user = "0", type = "PULSE";
  std::vector<ProgramNumber> configuration;

  void read(Scanner& s) {
    const auto word = [&] {
      s.skip_spaces();
      return std::string(s.name());
    };
    if (s.take("///TOOL ")) tool = word();
    if (s.take("///USER ")) user = word();
    if (s.take("///POSTYPE ")) type = word();
    if (!s.take("///RCONF ")) return;
    configuration.clear();
    do {
      s.skip_spaces();
      configuration.push_back(s.number());
      s.skip_spaces();
    } while (s.next() == ',');
  }

  // flip (1: axis 5 at or above zero), lower, rear, then whether axes 4, 6 and 1 are half a turn or more away.
  Configuration stated() const {
    Configuration out;
    const auto flag = [&](std::size_t k) { return configuration[k].value > 0.5; };
    if (configuration.size() < 6) return out;
    out.reading[4] = flag(0) ? wrist_positive : wrist_negative;
    out.lower = flag(1);
    out.rear = flag(2);
    constexpr std::size_t joints[3] = {3, 5, 0};
    for (std::size_t k = 0; k < 3; ++k) {
      // Half a turn and beyond is two ranges; the rest of the pose tells which.
      if (!flag(3 + k)) out.reading[joints[k]] = {-(one_turn_rad / 2), (one_turn_rad / 2)};
    }
    return out;
  }
};

}  // namespace

TargetText inform_targets(std::string_view text, const std::string& path) {
  TargetText out;
  out.language = ProgramLanguage::inform;
  InformState state;
  Scanner s(text, path);
  std::map<std::string, std::size_t> number;
  for (ProgramPosition& position : read_inform(text, path)) {
    while (s.at() < position.begin) {
      const std::size_t line = s.at();
      state.read(s);
      s.go(line);
      s.skip_line();
    }
    ProgramTarget target;
    target.position = std::move(position);
    if (target.position.name.starts_with("BC") || target.position.name.starts_with("EC")) continue;
    if (target.position.kind == ProgramPositionKind::pose) {
      if (target.position.numbers.size() < 6) s.fail_at(target.position.begin, "Found a position with too few numbers; expected X, Y, Z, Rx, Ry, Rz.");
      if (state.type != "USER" && state.type != "BASE" && state.type != "ROBOT") {
        s.fail_at(target.position.begin, "Found a Cartesian position under ///POSTYPE " + state.type + "; expected USER, BASE or ROBOT.");
      }
      target.tool = state.tool;
      target.frame = state.type == "USER" ? state.user : "";
      target.stated = state.stated();
      for (const ProgramNumber& flag : state.configuration) target.flags.push_back({flag, 0});
    }
    number[target.position.name] = out.targets.size();
    out.targets.push_back(std::move(target));
  }
  Scanner moves(text, path);
  bool in_moves = false;
  while (!moves.done()) {
    const std::size_t at = moves.at();
    in_moves = in_moves || moves.looks_at("//INST");
    if (in_moves && moves.take("MOV")) {
      const char kind = moves.next();
      moves.skip_spaces();
      const std::string name(moves.name());
      const auto known = number.find(name);
      ProgramMove move{kind == 'L' ? MoveKind::line : kind == 'C' || kind == 'S' ? MoveKind::circle : MoveKind::joint, at, {}};
      if (known != number.end()) move.targets.push_back(known->second);
      if (known == number.end() || kind == 'I') out.left_out.push_back({at, "is a variable or a shift (IMOV)"});
      out.moves.push_back(std::move(move));
    } else if (in_moves && moves.looks_at("IMOV")) {
      out.left_out.push_back({at, "is a variable or a shift (IMOV)"});
      out.moves.push_back({MoveKind::joint, at, {}});
    }
    moves.skip_line();
  }
  return out;
}

}  // namespace mdhcal::offline
