// SPDX-License-Identifier: MIT
// KUKA: DECL E6AXIS XP1={A1 1.5,A2 ...}, also {E6AXIS: A1 ...} and the shorter structures AXIS, POS, FRAME.
#include <array>

#include "offline/import/scanner.hpp"

namespace mdhcal::offline {

namespace {

// The components that a structure has, in the order in which they are handed on; those behind the sixth are external axes.
constexpr std::array<std::string_view, 12> axis_components{"A1", "A2", "A3", "A4", "A5", "A6", "E1", "E2", "E3", "E4", "E5", "E6"};
constexpr std::array<std::string_view, 6> pose_components{"X", "Y", "Z", "A", "B", "C"};

bool same_word(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  for (std::size_t k = 0; k < a.size(); ++k) {
    if ((a[k] | 0x20) != (b[k] | 0x20)) return false;
  }
  return true;
}

// The aggregate "{A1 1.5,A2 -3}" whose brace is here. Nothing if it is neither joints nor a pose.
std::optional<ProgramPosition> aggregate(Scanner& s) {
  ProgramPosition position;
  position.begin = s.at();
  s.expect('{');
  s.skip_spaces();
  const std::size_t first = s.at();
  // A type may stand in front: {E6AXIS: A1 1.5, ...}.
  const std::string_view type = s.name();
  s.skip_spaces();
  if (type.empty() || s.peek() != ':') {
    s.go(first);
  } else {
    s.next();
  }
  std::array<ProgramNumber, axis_components.size()> axes{};
  std::array<ProgramNumber, pose_components.size()> pose{};
  std::size_t axis_count = 0, pose_count = 0;
  while (!s.done() && s.peek() != '}' && s.peek() != '\n') {
    s.skip_spaces();
    const std::string_view component = s.name();
    s.skip_spaces();
    std::size_t a = 0, p = 0;
    while (a < axis_components.size() && !same_word(component, axis_components[a])) ++a;
    while (p < pose_components.size() && !same_word(component, pose_components[p])) ++p;
    if ((a < axis_components.size() || p < pose_components.size()) && s.at_number()) {
      const ProgramNumber number = s.number();
      if (a < axis_components.size()) {
        axes[a] = number;
        if (a < 6) ++axis_count;
      } else {
        pose[p] = number;
        ++pose_count;
      }
    } else {
      // Another component, or a variable in the place of a number.
      if (component == "A1" || component == "X") return {};
      while (!s.done() && s.peek() != ',' && s.peek() != '}' && s.peek() != '\n') {
        if (s.peek() == '"') {
          s.skip_string();
        } else {
          s.next();
        }
      }
    }
    s.skip_spaces();
    if (s.peek() == ',') s.next();
  }
  if (axis_count > 0) {
    for (std::size_t k = 0; k < axes.size(); ++k) {
      if (axes[k].end != 0) position.numbers.push_back(axes[k]);
      if (axes[k].end == 0 && k < axis_count) s.fail_at(position.begin, "Found a joint position without " + std::string(axis_components[k]) + "; expected A1, A2 and so on.");
    }
    return position;
  }
  if (pose_count == pose.size()) {
    position.kind = ProgramPositionKind::pose;
    position.numbers.assign(pose.begin(), pose.end());
    return position;
  }
  return {};
}

}  // namespace

std::vector<ProgramPosition> read_krl(std::string_view text, const std::string& path) {
  std::vector<ProgramPosition> positions;
  Scanner s(text, path);
  std::string name;
  while (!s.done()) {
    const char c = s.peek();
    if (c == ';' || c == '&') {
      s.skip_line();
      name.clear();
    } else if (c == '"') {
      s.skip_string();
    } else if (c == '\n') {
      name.clear();
      s.next();
    } else if (c == '{') {
      auto position = aggregate(s);
      if (position) {
        // Points of inline forms are called X and the point's name.
        const bool inline_form = name.size() > 1 && (name[0] == 'X' || name[0] == 'x');
        position->name = inline_form ? name.substr(1) : name;
        positions.push_back(std::move(*position));
      }
    } else if (const std::string_view word = s.name(); !word.empty()) {
      // The name is the last word in front of '='; an index belongs to it.
      std::string candidate(word);
      if (s.peek() == '[') {
        const std::size_t close = text.find(']', s.at());
        if (close != std::string_view::npos && close - s.at() < 12) {
          candidate += text.substr(s.at(), close - s.at() + 1);
          s.go(close + 1);
        }
      }
      s.skip_spaces();
      if (s.peek() == '=') name = candidate;
    } else {
      s.next();
    }
  }
  return positions;
}

}  // namespace mdhcal::offline
