// SPDX-License-Identifier: MIT
// URScript: [six joints] and p[pose] as first argument of a move or on the right of '='. A point's name is the variable,
// else the comment in front of the move ("# P1"), else its number.
#include "offline/import/scanner.hpp"

namespace mdhcal::offline {

namespace {

// The list "[1, 2, 3]" here; empty, and the place behind the bracket, if it holds something else.
std::vector<ProgramNumber> six_numbers(Scanner& s) {
  std::vector<ProgramNumber> numbers;
  s.expect('[');
  while (true) {
    s.skip_blanks();
    if (!s.at_number()) return {};
    numbers.push_back(s.number());
    s.skip_blanks();
    if (s.peek() == ']') break;
    if (s.peek() != ',') return {};
    s.next();
  }
  s.next();
  if (numbers.size() != 6) return {};
  return numbers;
}

bool is_move(std::string_view word) { return word == "movej" || word == "movel" || word == "movep" || word == "movec" || word == "servoj"; }

}  // namespace

std::vector<ProgramPosition> read_urscript(std::string_view text, const std::string& path) {
  std::vector<ProgramPosition> positions;
  Scanner s(text, path);
  std::string comment;
  while (!s.done()) {
    const char c = s.peek();
    if (c == '#') {
      const std::size_t start = s.at() + 1;
      s.skip_line();
      std::string_view line = text.substr(start, s.at() - start);
      while (!line.empty() && (line.front() == ' ' || line.front() == '\t')) line.remove_prefix(1);
      while (!line.empty() && (line.back() == ' ' || line.back() == '\t' || line.back() == '\r' || line.back() == '\n')) line.remove_suffix(1);
      comment = line.substr(0, 60);
      continue;
    }
    if (c == '"' || c == '\'') {
      s.skip_string();
      continue;
    }
    const std::string_view word = s.name();
    if (word.empty()) {
      s.next();
      continue;
    }
    s.skip_spaces();
    std::string name;
    if (s.peek() == '=' && s.at() + 1 < text.size() && text[s.at() + 1] != '=') {
      name = word;
      // a=1.2 in a move's arguments is no point.
      s.next();
    } else if (s.peek() == '(' && is_move(word)) {
      s.next();
    } else {
      continue;
    }
    s.skip_spaces();
    ProgramPosition position;
    position.begin = s.at();
    if (s.looks_at("p[")) {
      s.next();
      position.kind = ProgramPositionKind::pose;
    }
    if (s.peek() != '[') continue;
    position.numbers = six_numbers(s);
    if (position.numbers.empty() || name == "qnear") continue;
    position.radians = true;
    position.name = !name.empty() ? name : !comment.empty() ? comment : std::to_string(positions.size() + 1);
    if (name.empty()) comment.clear();
    positions.push_back(std::move(position));
  }
  return positions;
}

}  // namespace mdhcal::offline
