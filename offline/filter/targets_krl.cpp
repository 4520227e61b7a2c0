// SPDX-License-Identifier: MIT
// KUKA: E6POS XP1={X ..,C ..,S 2,T 4,E1 ..}; FDAT FP1={TOOL_NO 1,BASE_NO 1,...} names tool and base of XP1.
#include <cmath>
#include <set>
#include <tuple>

#include "offline/filter/target_text.hpp"
#include "offline/import/scanner.hpp"

namespace mdhcal::offline {

namespace {

// The number of a component of the aggregate [begin, its brace); nothing if it is not there.
std::optional<ProgramNumber> component_in(std::string_view text, const std::string& path, std::size_t begin, std::string_view name) {
  Scanner s(text, path);
  s.go(begin);
  while (!s.done() && s.peek() != '}' && s.peek() != '\n') {
    if (s.peek() == '"') {
      s.skip_string();
      continue;
    }
    const std::string_view word = s.name();
    if (word.empty()) {
      s.next();
      continue;
    }
    s.skip_spaces();
    if (small_letters(word) == name && s.at_number()) return s.number();
  }
  return {};
}

bool whole(double value, double most) { return value >= 0 && value <= most && !(std::abs(value - std::floor(value)) > 0); }

void read_status_and_turn(std::string_view text, const std::string& path, ProgramTarget& target) {
  const auto status = component_in(text, path, target.position.begin, "s");
  const auto turn = component_in(text, path, target.position.begin, "t");
  if (turn) {
    if (!whole(turn->value, 63)) Scanner(text, path).fail_at(turn->begin, "Found a turn T that is no whole number from 0 to 63.");
    const int t = static_cast<int>(turn->value);
    for (std::size_t j = 0; j < 6; ++j) target.stated.reading[j] = ((t >> j) & 1) != 0 ? ReadingRange{-unbounded, 0} : ReadingRange{0, unbounded};
    target.flags.push_back({*turn, 0});
  }
  // Behind T, whose sign of axis 5 does not end at half a turn.
  if (status) {
    if (!whole(status->value, 63)) Scanner(text, path).fail_at(status->begin, "Found a status S that is no whole number from 0 to 63.");
    const int s = static_cast<int>(status->value);
    target.stated.rear = (s & 1) != 0;
    target.stated.lower = (s & 2) == 0;
    target.stated.reading[4] = (s & 4) != 0 ? wrist_negative : wrist_positive;
  }
}

}  // namespace

TargetText krl_targets(std::string_view text, const std::string& path) {
  TargetText out;
  out.language = ProgramLanguage::krl;
  // FDAT by the point's name.
  std::map<std::string, std::pair<std::string, std::string>> frames;
  std::set<std::pair<std::string, std::string>> used;
  Scanner s(text, path);
  while (!s.done()) {
    if (s.peek() == ';' || s.peek() == '&') {
      s.skip_line();
    } else if (s.peek() == '"') {
      s.skip_string();
    } else {
      const std::string_view word = s.name();
      if (word.empty()) {
        s.next();
      } else if (small_letters(word) == "fdat") {
        s.skip_spaces();
        const std::string name = small_letters(s.name());
        const auto tool = component_in(text, path, s.at(), "tool_no");
        const auto base = component_in(text, path, s.at(), "base_no");
        if (tool && base && name.size() > 1 && name[0] == 'f') {
          const std::pair<std::string, std::string> pair{number_name(*tool), number_name(*base)};
          frames[name.substr(1)] = pair;
          used.insert(pair);
        }
      }
    }
  }
  for (ProgramPosition& position : read_krl(text, path)) {
    ProgramTarget target;
    const std::string name = small_letters(position.name);
    if (position.kind == ProgramPositionKind::pose) {
      if (name.starts_with("tool_data") || name.starts_with("base_data") || name.starts_with("$")) continue;
      target.position = std::move(position);
      read_status_and_turn(text, path, target);
      if (target.position.name.empty() && target.flags.empty()) {
        out.left_out.push_back({target.position.begin, "is written out in the move without S and T"});
        continue;
      }
      const auto known = frames.find(name);
      target.tool = target.frame = unknown_name;
      if (known != frames.end() || used.size() == 1) std::tie(target.tool, target.frame) = known != frames.end() ? known->second : *used.begin();
    } else {
      target.position = std::move(position);
    }
    out.targets.push_back(std::move(target));
  }
  return out;
}

}  // namespace mdhcal::offline
