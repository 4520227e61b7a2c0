// SPDX-License-Identifier: MIT
// Yaskawa: //POS with state lines (///PULSE, ///ANGLE, ///RECTAN) and records C00000=1,2,3,4,5,6.
#include "offline/import/scanner.hpp"

namespace mdhcal::offline {

std::vector<ProgramPosition> read_inform(std::string_view text, const std::string& path) {
  std::vector<ProgramPosition> positions;
  Scanner s(text, path);
  bool in_positions = false;
  ProgramPositionKind kind = ProgramPositionKind::pulses;
  while (!s.done()) {
    s.skip_spaces();
    if (s.looks_at("//POS")) {
      in_positions = true;
    } else if (s.looks_at("//INST")) {
      break;
    } else if (s.looks_at("///PULSE")) {
      kind = ProgramPositionKind::pulses;
    } else if (s.looks_at("///ANGLE")) {
      kind = ProgramPositionKind::joints;
    } else if (s.looks_at("///RECTAN")) {
      kind = ProgramPositionKind::pose;
    } else if (in_positions && (s.peek() == 'C' || s.peek() == 'P')) {
      ProgramPosition position;
      position.begin = s.at();
      position.kind = kind;
      position.name = s.name();
      s.skip_spaces();
      if (s.peek() == '=') {
        s.next();
        s.skip_spaces();
        position.numbers.push_back(s.number());
        s.skip_spaces();
        while (s.peek() == ',') {
          s.next();
          s.skip_spaces();
          position.numbers.push_back(s.number());
          s.skip_spaces();
        }
        positions.push_back(std::move(position));
      }
    }
    s.skip_line();
  }
  return positions;
}

}  // namespace mdhcal::offline
