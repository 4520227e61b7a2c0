// SPDX-License-Identifier: MIT
// Staubli VAL3 data files: <Data name="j" type="jointRx"><Value key="0" j1="1.5" .../></Data>. An attribute that is left out is 0.
// Written by one program in one form: the tags are read as text, so that the place of each number is known.
#include <array>

#include "offline/import/scanner.hpp"

namespace mdhcal::offline {

namespace {

// The value of an attribute of the tag [begin, end); its place in `at`. Nothing if it is not there.
std::optional<std::string_view> attribute(std::string_view text, std::size_t begin, std::size_t end, std::string_view name, std::size_t& at) {
  const std::string_view tag = text.substr(begin, end - begin);
  for (std::size_t k = tag.find(name); k != std::string_view::npos; k = tag.find(name, k + 1)) {
    const bool own = k > 0 && (tag[k - 1] == ' ' || tag[k - 1] == '\t' || tag[k - 1] == '\n' || tag[k - 1] == '\r');
    const std::size_t behind = k + name.size();
    if (!own || behind + 1 >= tag.size() || tag[behind] != '=' || (tag[behind + 1] != '"' && tag[behind + 1] != '\'')) continue;
    const std::size_t close = tag.find(tag[behind + 1], behind + 2);
    if (close == std::string_view::npos) return {};
    at = begin + behind + 2;
    return tag.substr(behind + 2, close - behind - 2);
  }
  return {};
}

}  // namespace

std::vector<ProgramPosition> read_val3(std::string_view text, const std::string& path) {
  constexpr std::array<std::string_view, 6> joint_keys{"j1", "j2", "j3", "j4", "j5", "j6"};
  constexpr std::array<std::string_view, 6> pose_keys{"x", "y", "z", "rx", "ry", "rz"};
  std::vector<ProgramPosition> positions;
  Scanner s(text, path);
  std::string data_name;
  bool joints = false, points = false;
  while (!s.done()) {
    if (s.take("<!--")) {
      const std::size_t close = text.find("-->", s.at());
      s.go(close == std::string_view::npos ? text.size() : close);
      continue;
    }
    if (s.peek() != '<') {
      s.next();
      continue;
    }
    const std::size_t begin = s.at();
    const std::size_t end = text.find('>', begin);
    if (end == std::string_view::npos) s.fail("Found a tag that is not closed; expected '>'.");
    std::size_t at = 0;
    if (s.looks_at("<Data ")) {
      data_name = attribute(text, begin, end, "name", at).value_or("");
      const std::string_view type = attribute(text, begin, end, "type", at).value_or("");
      joints = type == "jointRx";
      points = type == "pointRx";
    } else if (s.looks_at("</Data")) {
      joints = points = false;
    } else if (s.looks_at("<Value ") && (joints || points)) {
      ProgramPosition position;
      position.begin = begin;
      position.kind = joints ? ProgramPositionKind::joints : ProgramPositionKind::pose;
      position.name = data_name + '[' + std::string(attribute(text, begin, end, "key", at).value_or("0")) + ']';
      for (const std::string_view key : joints ? joint_keys : pose_keys) {
        ProgramNumber number;
        const auto value = attribute(text, begin, end, key, at);
        if (value) {
          s.go(at);
          number = s.number();
          if (number.end != at + value->size()) s.fail("Found text behind a number; expected the attribute's end.");
        }
        position.numbers.push_back(number);
      }
      positions.push_back(std::move(position));
    }
    s.go(end + 1);
  }
  return positions;
}

}  // namespace mdhcal::offline
