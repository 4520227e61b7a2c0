// SPDX-License-Identifier: MIT
// ABB: robtarget [[x,y,z],[q1,q2,q3,q4],[cf1,cf4,cf6,cfx],[externals]]; tool and work object stand in the moves.
#include <algorithm>
#include <array>

#include "offline/base/error.hpp"
#include "offline/filter/target_text.hpp"
#include "offline/import/scanner.hpp"

namespace mdhcal::offline {

namespace {

void skip_rapid(Scanner& s) {
  while (true) {
    s.skip_blanks();
    if (s.peek() != '!') return;
    s.skip_line();
  }
}

// Every number and word between the bracket that is here and the one that closes it, in order.
std::vector<std::string> flat_list(Scanner& s, std::vector<double>& numbers) {
  std::vector<std::string> words;
  std::size_t depth = 0;
  do {
    skip_rapid(s);
    const char c = s.peek();
    if (c == '[') {
      ++depth;
      s.next();
    } else if (c == ']') {
      --depth;
      s.next();
    } else if (c == '"') {
      const std::size_t begin = s.at();
      s.skip_string();
      words.emplace_back(s.text().substr(begin, s.at() - begin));
    } else if (s.at_number()) {
      numbers.push_back(s.number().value);
    } else if (const std::string_view word = s.name(); !word.empty()) {
      words.push_back(small_letters(word));
    } else if (c == ',') {
      s.next();
    } else {
      s.fail("Found something else than numbers in a declaration of a tool or a work object; expected it written out.");
    }
  } while (depth > 0 && !s.done());
  if (depth > 0) s.fail("Found a list that is not closed; expected ']'.");
  return words;
}

std::vector<double> seven(const std::vector<double>& numbers, std::size_t first) {
  return {numbers.begin() + static_cast<std::ptrdiff_t>(first), numbers.begin() + static_cast<std::ptrdiff_t>(first + 7)};
}

void tool_declaration(Scanner& s, ProgramFrames& out) {
  const std::string name = small_letters(s.name());
  skip_rapid(s);
  if (!s.take(":=")) return;
  skip_rapid(s);
  const std::size_t begin = s.at();
  std::vector<double> numbers;
  const std::vector<std::string> words = flat_list(s, numbers);
  if (numbers.size() < 7 || words.empty()) s.fail_at(begin, "Found a tooldata with too few numbers; expected [TRUE,[[x,y,z],[q1,q2,q3,q4]],...].");
  if (words[0] != "true") out.refused[name] = "the tool stands beside the robot, which holds the work piece (robhold FALSE)";
  out.tools[name] = frame_from(ProgramLanguage::rapid, seven(numbers, 0));
}

void frame_declaration(Scanner& s, ProgramFrames& out) {
  const std::string name = small_letters(s.name());
  skip_rapid(s);
  if (!s.take(":=")) return;
  skip_rapid(s);
  const std::size_t begin = s.at();
  std::vector<double> numbers;
  const std::vector<std::string> words = flat_list(s, numbers);
  if (numbers.size() < 14 || words.size() < 3) s.fail_at(begin, "Found a wobjdata with too few numbers; expected [FALSE,TRUE,\"\",[uframe],[oframe]].");
  if (words[0] != "false") out.refused[name] = "the robot holds the work piece (robhold TRUE)";
  if (words[1] != "true" || words[2] != "\"\"") out.refused[name] = "its user frame is moved by a mechanical unit (ufprog FALSE, or ufmec)";
  out.frames[name] = compose(frame_from(ProgramLanguage::rapid, seven(numbers, 0)), frame_from(ProgramLanguage::rapid, seven(numbers, 7)));
}

// [cf1,cf4,cf6,cfx] behind the rotation's bracket.
void read_confdata(Scanner& s, ProgramTarget& target) {
  s.go(target.position.numbers[6].end);
  skip_rapid(s);
  s.expect(']');
  skip_rapid(s);
  s.expect(',');
  skip_rapid(s);
  s.expect('[');
  constexpr std::array<std::int32_t, 3> joints{0, 3, 5};
  for (std::size_t k = 0; k < 4; ++k) {
    skip_rapid(s);
    const ProgramNumber number = s.number();
    skip_rapid(s);
    if (k < 3) {
      target.flags.push_back({number, joints[k]});
      target.stated.reading[static_cast<std::size_t>(joints[k])] = {number.value * (one_turn_rad / 4), (number.value + 1) * (one_turn_rad / 4)};
      s.expect(',');
    } else if (number.value >= 0 && number.value < 8) {
      // The wrist's centre in front of the lower arm (0, 1, 4, 5) or behind it; shoulder and wrist are in the quadrants already.
      target.stated.lower = (static_cast<int>(number.value) & 2) != 0;
    }
  }
  s.expect(']');
}

struct MoveArgument {
  std::size_t at = 0;
  std::string_view text;
};

// The arguments up to the semicolon, parted by the commas outside brackets.
std::vector<MoveArgument> move_arguments(Scanner& s) {
  std::vector<MoveArgument> out;
  std::size_t depth = 0, begin = s.at();
  while (!s.done()) {
    const char c = s.peek();
    if (c == '"') {
      s.skip_string();
      continue;
    }
    if (c == '!') {
      s.skip_line();
      continue;
    }
    if (c == '(' || c == '[' || c == '{') ++depth;
    if ((c == ')' || c == ']' || c == '}') && depth > 0) --depth;
    if (c == ';' || (c == ',' && depth == 0)) {
      out.push_back({begin, s.text().substr(begin, s.at() - begin)});
      begin = s.at() + 1;
    }
    s.next();
    if (c == ';') break;
  }
  for (MoveArgument& a : out) {
    while (!a.text.empty() && (a.text.front() == ' ' || a.text.front() == '\t' || a.text.front() == '\r' || a.text.front() == '\n')) {
      a.text.remove_prefix(1);
      ++a.at;
    }
  }
  return out;
}

std::string first_name(std::string_view text) {
  std::size_t n = 0;
  while (n < text.size() && text[n] != '\\' && text[n] != ' ' && text[n] != '\t' && text[n] != '\r' && text[n] != '\n' && text[n] != '(') ++n;
  return small_letters(text.substr(0, n));
}

std::optional<MoveKind> kind_of(std::string_view word) {
  if (word.starts_with("moveabsj") || word.starts_with("movej") || word == "triggj") return MoveKind::joint;
  if (word.starts_with("movel") || word.starts_with("arcl") || word == "triggl" || word == "searchl") return MoveKind::line;
  if (word.starts_with("movec") || word.starts_with("arcc") || word == "triggc" || word == "searchc") return MoveKind::circle;
  return {};
}

class Rapid {
 public:
  Rapid(std::string_view text, const std::string& path, const ProgramFrames& beside) : text_(text), path_(path) {
    out_.language = ProgramLanguage::rapid;
    out_.frames = rapid_frames(text, path);
    tools_ = out_.frames.tools;
    tools_.insert(beside.tools.begin(), beside.tools.end());
    for (ProgramPosition& position : read_rapid(text, path)) {
      ProgramTarget target;
      target.position = std::move(position);
      if (target.position.kind == ProgramPositionKind::pose) {
        Scanner s(text, path);
        read_confdata(s, target);
      }
      number_[small_letters(target.position.name)] = out_.targets.size();
      out_.targets.push_back(std::move(target));
    }
  }

  TargetText read() {
    Scanner s(text_, path_);
    while (!s.done()) {
      if (s.peek() == '!') {
        s.skip_line();
      } else if (s.peek() == '"') {
        s.skip_string();
      } else {
        const std::size_t at = s.at();
        const std::string word = small_letters(s.name());
        if (word.empty()) {
          s.next();
        } else if (const auto kind = kind_of(word); kind && (s.peek() == ' ' || s.peek() == '\t' || s.peek() == '\\')) {
          move(at, *kind, move_arguments(s));
        }
      }
    }
    settle_unused();
    return std::move(out_);
  }

 private:
  void use(std::size_t target, const std::string& tool, const std::string& frame, std::size_t at) {
    const auto [known, added] = uses_.insert({target, {tool, frame}});
    if (!added && known->second != std::pair{tool, frame}) {
      Scanner(text_, path_).fail_at(at, "Found target " + out_.targets[target].position.name +
                                            " moved to with a second tool or work object; expected one, for one text has one correction.");
    }
    out_.targets[target].tool = tool;
    out_.targets[target].frame = frame;
  }

  void move(std::size_t at, MoveKind kind, const std::vector<MoveArgument>& all) {
    if (all.size() < 2) return;
    // The tool is the argument that names one; further arguments may stand behind it.
    const MoveArgument* tool = &all.back();
    for (const MoveArgument& a : all) {
      if (tools_.count(first_name(a.text)) != 0 || first_name(a.text) == "tool0") tool = &a;
    }
    std::string frame = "wobj0";
    const std::string small = small_letters(tool->text);
    if (const std::size_t w = small.find("\\wobj:="); w != std::string::npos) frame = first_name(std::string_view(small).substr(w + 7));
    ProgramMove move{kind, at, {}};
    const std::size_t count = kind == MoveKind::circle ? 2 : 1;
    for (std::size_t k = 0; k < count && k < all.size(); ++k) {
      const std::string name = first_name(all[k].text);
      const auto known = number_.find(name);
      if (known != number_.end()) {
        use(known->second, first_name(tool->text), frame, all[k].at);
        move.targets.push_back(known->second);
        continue;
      }
      move.targets.clear();
      out_.left_out.push_back({all[k].at, all[k].text.find('(') != std::string_view::npos ? "is computed by the program"
                                          : all[k].text.starts_with("[") ? "is written out in the move"
                                                                         : "is declared in another file"});
      // What a function such as Offs() starts from is a target like others.
      if (const std::size_t open = all[k].text.find('('); open != std::string_view::npos) {
        const std::string_view inside = all[k].text.substr(open + 1);
        const auto base = number_.find(first_name(inside.substr(0, inside.find(','))));
        if (base != number_.end()) use(base->second, first_name(tool->text), frame, all[k].at);
      }
      break;
    }
    out_.moves.push_back(std::move(move));
  }

  // Targets that no move of this module names: what all the others have is theirs.
  void settle_unused() {
    for (std::size_t k = 0; k < out_.targets.size(); ++k) {
      ProgramTarget& target = out_.targets[k];
      if (uses_.count(k) != 0 || target.position.kind != ProgramPositionKind::pose) continue;
      const bool one = std::all_of(uses_.begin(), uses_.end(), [&](const auto& use) { return use.second == uses_.begin()->second; });
      target.tool = target.frame = unknown_name;
      if (uses_.empty() || !one) continue;
      target.tool = uses_.begin()->second.first;
      target.frame = uses_.begin()->second.second;
    }
  }

  std::string_view text_;
  const std::string& path_;
  TargetText out_;
  std::map<std::string, Frame<double>> tools_;
  std::map<std::string, std::size_t> number_;
  std::map<std::size_t, std::pair<std::string, std::string>> uses_;
};

}  // namespace

ProgramFrames rapid_frames(std::string_view text, const std::string& path) {
  ProgramFrames out;
  Scanner s(text, path);
  while (!s.done()) {
    if (s.peek() == '!') {
      s.skip_line();
    } else if (s.peek() == '"') {
      s.skip_string();
    } else {
      const std::string word = small_letters(s.name());
      if (word.empty()) {
        s.next();
      } else if (word == "tooldata" || word == "wobjdata") {
        skip_rapid(s);
        word == "tooldata" ? tool_declaration(s, out) : frame_declaration(s, out);
      }
    }
  }
  const Frame<double> none = frame_of(Pose<double>{{1, 0, 0, 0}, {0, 0, 0}});
  out.tools["tool0"] = none;
  out.frames["wobj0"] = none;
  return out;
}

TargetText rapid_targets(std::string_view text, const std::string& path, const ProgramFrames& frames) { return Rapid(text, path, frames).read(); }

}  // namespace mdhcal::offline
