// SPDX-License-Identifier: MIT
// ABB: CONST jointtarget p1:=[[1.5,...],[9E9,...]]; robtarget p2:=[[x,y,z],[q1,q2,q3,q4],[0,0,0,0],[9E9,...]]; arrays too.
#include "offline/import/scanner.hpp"

namespace mdhcal::offline {

namespace {

// Blanks, ends of lines and comments ("!" to the end of the line).
void skip_rapid_blanks(Scanner& s) {
  while (true) {
    s.skip_blanks();
    if (s.peek() != '!') return;
    s.skip_line();
  }
}

// The list of numbers "[1,2,3]" here, behind what is in `numbers`. False if it holds something else.
bool list_of_numbers(Scanner& s, std::vector<ProgramNumber>& numbers) {
  s.expect('[');
  while (true) {
    skip_rapid_blanks(s);
    if (!s.at_number()) return false;
    numbers.push_back(s.number());
    skip_rapid_blanks(s);
    if (s.peek() == ']') {
      s.next();
      return true;
    }
    s.expect(',');
  }
}

// One target whose bracket is here; moves behind its first lists of numbers. Nothing if it holds names.
std::optional<ProgramPosition> target(Scanner& s, bool joints) {
  ProgramPosition position;
  position.begin = s.at();
  s.expect('[');
  skip_rapid_blanks(s);
  position.kind = joints ? ProgramPositionKind::joints : ProgramPositionKind::pose;
  if (s.peek() != '[' || !list_of_numbers(s, position.numbers)) return {};
  skip_rapid_blanks(s);
  if (s.peek() == ',') {
    s.next();
    skip_rapid_blanks(s);
    std::vector<ProgramNumber> more;
    if (s.peek() != '[' || !list_of_numbers(s, more)) return {};
    for (const ProgramNumber& number : more) {
      // 9E9 stands for an axis that is not there.
      if (!joints || number.value < 8.9e9) position.numbers.push_back(number);
    }
  }
  if (position.numbers.size() < (joints ? 6U : 7U)) s.fail_at(position.begin, "Found a target with too few numbers; expected six joints, or a point and a quaternion.");
  return position;
}

// Behind the target's last bracket: `depth` brackets are open.
void close_brackets(Scanner& s, std::size_t depth) {
  while (!s.done() && depth > 0 && s.peek() != ';') {
    const char c = s.peek();
    if (c == '"') {
      s.skip_string();
      continue;
    }
    if (c == '!') {
      s.skip_line();
      continue;
    }
    if (c == '[') ++depth;
    if (c == ']') --depth;
    s.next();
  }
}

void declaration(Scanner& s, bool joints, std::vector<ProgramPosition>& positions) {
  skip_rapid_blanks(s);
  const std::string name(s.name());
  skip_rapid_blanks(s);
  bool array = false;
  if (s.peek() == '{') {
    array = true;
    while (!s.done() && s.peek() != '}' && s.peek() != ';') s.next();
    if (s.peek() == '}') s.next();
    skip_rapid_blanks(s);
  }
  if (!s.take(":=")) return;  // a parameter, or without a value
  skip_rapid_blanks(s);
  if (s.peek() != '[') return;
  if (!array) {
    auto position = target(s, joints);
    if (position) {
      position->name = name;
      positions.push_back(std::move(*position));
    }
    close_brackets(s, 1);
    return;
  }
  s.next();
  for (std::size_t index = 1; !s.done(); ++index) {
    skip_rapid_blanks(s);
    if (s.peek() != '[') break;
    auto position = target(s, joints);
    if (position) {
      position->name = name + '{' + std::to_string(index) + '}';
      positions.push_back(std::move(*position));
    }
    close_brackets(s, 1);
    skip_rapid_blanks(s);
    if (s.peek() != ',') break;
    s.next();
  }
}

}  // namespace

std::vector<ProgramPosition> read_rapid(std::string_view text, const std::string& path) {
  std::vector<ProgramPosition> positions;
  Scanner s(text, path);
  while (!s.done()) {
    if (s.peek() == '!') {
      s.skip_line();
    } else if (s.peek() == '"') {
      s.skip_string();
    } else {
      const std::string_view word = s.name();
      if (word.empty()) {
        s.next();
        continue;
      }
      std::string small;
      for (const char c : word) small += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
      if (small == "jointtarget" || small == "robtarget") declaration(s, small == "jointtarget", positions);
    }
  }
  return positions;
}

}  // namespace mdhcal::offline
