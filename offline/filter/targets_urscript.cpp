// SPDX-License-Identifier: MIT
// URScript: [six joints] and p[pose] in moves, alone or as what pose_trans() and get_inverse_kin() start from, and in variables that
// moves name. No flags: the controller takes the solution nearest to its joints, or to qnear.
#include <algorithm>
#include <set>

#include "offline/filter/target_text.hpp"
#include "offline/import/scanner.hpp"

namespace mdhcal::offline {

namespace {

// Blanks and comments.
void skip_script(Scanner& s) {
  while (true) {
    s.skip_blanks();
    if (s.peek() != '#') return;
    s.skip_line();
  }
}

class UrScript {
 public:
  UrScript(std::string_view text, const std::string& path) : text_(text), s_(text, path) { out_.language = ProgramLanguage::urscript; }

  TargetText read() {
    // Variables first: a move in a function may stand before the assignment.
    walk(false);
    walk(true);
    return std::move(out_);
  }

 private:
  void walk(bool moves) {
    s_.go(0);
    while (!s_.done()) {
      const char c = s_.peek();
      if (c == '#') {
        s_.skip_line();
      } else if (c == '"' || c == '\'') {
        s_.skip_string();
      } else {
        const std::size_t at = s_.at();
        const std::string word(s_.name());
        if (word.empty()) {
          s_.next();
          continue;
        }
        s_.skip_spaces();
        if (moves && s_.peek() == '(') {
          call(at, word);
        } else if (!moves && s_.peek() == '=' && text_.substr(s_.at() + 1, 1) != "=") {
          s_.next();
          s_.skip_spaces();
          const auto literal = six();
          if (literal) assigned_[word].push_back(*literal);
        }
      }
    }
  }

  // p[six numbers] or [six numbers] here. Nothing, and nothing passed over, if it is something else.
  std::optional<ProgramPosition> six() {
    const std::size_t begin = s_.at();
    ProgramPosition position;
    position.begin = begin;
    position.radians = true;
    if (s_.looks_at("p[")) {
      s_.next();
      position.kind = ProgramPositionKind::pose;
    }
    bool whole = s_.peek() == '[';
    while (whole && position.numbers.size() < 6) {
      s_.next();
      skip_script(s_);
      whole = s_.at_number();
      if (!whole) break;
      position.numbers.push_back(s_.number());
      skip_script(s_);
      whole = s_.peek() == (position.numbers.size() == 6 ? ']' : ',');
    }
    if (!whole) {
      s_.go(begin);
      return {};
    }
    s_.next();
    return position;
  }

  void call(std::size_t at, const std::string& word) {
    static const std::map<std::string, MoveKind> kinds{
        {"movej", MoveKind::joint}, {"movel", MoveKind::line}, {"movep", MoveKind::line}, {"movec", MoveKind::circle}};
    const auto kind = kinds.find(word);
    if (word == "set_tcp") {
      s_.next();
      skip_script(s_);
      const auto pose = six();
      tool_ = unknown_name;
      if (pose && pose->kind == ProgramPositionKind::pose) {
        tool_ = "set_tcp " + std::to_string(out_.frames.tools.size() + 1);
        std::vector<double> numbers;
        for (const ProgramNumber& n : pose->numbers) numbers.push_back(n.value);
        out_.frames.tools[tool_] = frame_from(ProgramLanguage::urscript, numbers);
      }
      return;
    }
    if (kind == kinds.end()) return;
    s_.next();
    ProgramMove move{kind->second, at, {}};
    bool plain = true;
    for (int k = 0; k < (kind->second == MoveKind::circle ? 2 : 1); ++k) {
      if (k > 0 && s_.peek() == ',') s_.next();
      plain = goal(move.targets, 0) && plain;
      skip_script(s_);
    }
    if (!plain) move.targets.clear();
    out_.moves.push_back(std::move(move));
  }

  // The number of the target of a literal, once for each place in the text.
  std::size_t target_of(ProgramPosition position, const std::string& name) {
    const auto [known, added] = number_.insert({position.begin, out_.targets.size()});
    if (added) {
      ProgramTarget target;
      position.name = name.empty() ? "in line " + std::to_string(line_of(text_, position.begin)) : name;
      target.position = std::move(position);
      target.tool = tool_;
      out_.targets.push_back(std::move(target));
    } else if (out_.targets[known->second].position.kind == ProgramPositionKind::pose && out_.targets[known->second].tool != tool_) {
      s_.fail("Found target " + out_.targets[known->second].position.name + " moved to under a second set_tcp(); expected one, for one text has one correction.");
    }
    return known->second;
  }

  // The goal of a move. True if it is a target as it stands; what a function starts from is a target all the same. Functions nest to
  // a bounded depth.
  bool goal(std::vector<std::size_t>& targets, int depth) {
    skip_script(s_);
    const std::size_t at = s_.at();
    if (auto literal = six()) {
      targets.push_back(target_of(std::move(*literal), ""));
      return true;
    }
    const std::string word(s_.name());
    skip_script(s_);
    if (s_.peek() != '(') {
      const auto known = assigned_.find(word);
      if (known == assigned_.end()) {
        out_.left_out.push_back({at, "is computed by the program"});
        return false;
      }
      for (const ProgramPosition& value : known->second) targets.push_back(target_of(value, word));
      return known->second.size() == 1;
    }
    s_.next();
    const bool inverse = word == "get_inverse_kin";
    if (!inverse) out_.left_out.push_back({at, "is computed by the program"});
    bool plain = false;
    if ((inverse || word == "pose_trans") && depth < 8) plain = goal(targets, depth + 1);
    // To the bracket that closes the call.
    for (std::size_t open = 1; open > 0 && !s_.done();) {
      const char c = s_.peek();
      if (c == '#') {
        s_.skip_line();
        continue;
      }
      if (inverse && plain && s_.take("qnear")) {
        s_.skip_spaces();
        if (s_.peek() == '=') s_.next();
        s_.skip_spaces();
        if (const auto near = six(); near && near->kind == ProgramPositionKind::joints) {
          Joints seed{};
          for (std::size_t j = 0; j < 6; ++j) seed[j] = near->numbers[j].value;
          out_.targets[targets.back()].seed = seed;
        }
        continue;
      }
      if (c == '(') ++open;
      if (c == ')') --open;
      s_.next();
    }
    return inverse && plain;
  }

  std::string_view text_;
  Scanner s_;
  TargetText out_;
  std::string tool_ = unknown_name;
  std::map<std::string, std::vector<ProgramPosition>> assigned_;
  std::map<std::size_t, std::size_t> number_;
};

}  // namespace

TargetText urscript_targets(std::string_view text, const std::string& path) { return UrScript(text, path).read(); }

}  // namespace mdhcal::offline
