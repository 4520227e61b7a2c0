// SPDX-License-Identifier: MIT
// Staubli: <Value key="0" x="1" ... shoulder="ssame" elbow="epositive" wrist="wpositive" fatherId="fFix[0]" />. The moves stand in
// another file; what they name as tool is the only one here, or asked for.
#include <set>

#include "offline/filter/target_text.hpp"
#include "offline/import/scanner.hpp"

namespace mdhcal::offline {

namespace {

// The value of an attribute of a tag; empty if it is not there.
std::string value_of(std::string_view tag, const std::string& name) {
  for (const char quote : {'"', '\''}) {
    const std::string key = ' ' + name + '=' + quote;
    const std::size_t at = tag.find(key);
    if (at == std::string_view::npos) continue;
    const std::size_t begin = at + key.size(), end = tag.find(quote, begin);
    if (end != std::string_view::npos) return std::string(tag.substr(begin, end - begin));
  }
  return {};
}

std::string_view tag_from(std::string_view text, std::size_t begin) { return text.substr(begin, text.find('>', begin) - begin); }

struct Placed {
  Frame<double> father_T_frame;
  std::string father;
};

double component_of(std::string_view tag, const std::string& name, const std::string& path, std::string_view text, std::size_t at) {
  const std::string value = value_of(tag, name);
  if (value.empty()) return 0;
  const std::string where = path;
  Scanner s(value, where);
  if (!s.at_number()) Scanner(text, path).fail_at(at, "Found " + name + "=\"" + value + "\"; expected a number.");
  return s.number().value;
}

}  // namespace

TargetText val3_targets(std::string_view text, const std::string& path) {
  TargetText out;
  out.language = ProgramLanguage::val3;
  std::map<std::string, Placed> placed;
  std::string data;
  std::string type;
  for (Scanner s(text, path); !s.done(); s.next()) {
    if (s.looks_at("<!--")) s.go(text.find("-->", s.at()));
    const std::string_view tag = s.peek() == '<' ? tag_from(text, s.at()) : std::string_view();
    if (s.looks_at("<Data ")) {
      data = value_of(tag, "name");
      type.clear();
      for (const std::string known : {"frame", "tool"}) {
        if (tag.find(" type=\"" + known + '"') != std::string_view::npos) type = known;
      }
    } else if (s.looks_at("</Data>")) {
      type.clear();
    } else if (s.looks_at("<Value ") && !type.empty()) {
      std::vector<double> numbers;
      for (const char* name : {"x", "y", "z", "rx", "ry", "rz"}) numbers.push_back(component_of(tag, name, path, text, s.at()));
      const std::string key = data + '[' + (value_of(tag, "key").empty() ? "0" : value_of(tag, "key")) + ']';
      const std::string father = value_of(tag, "fatherId");
      (type == "frame" ? placed[key] : placed["tool " + key]) = {frame_from(ProgramLanguage::val3, numbers), father};
    }
  }
  // Frames stand on frames, up to the world; tools on tools, up to the flange. A ring of fathers ends after as many steps as there are.
  for (const auto& [key, first] : placed) {
    const bool tool = key.starts_with("tool ");
    Frame<double> whole = first.father_T_frame;
    std::string father = first.father;
    std::size_t steps = 0;
    while (!father.empty() && father != "world[0]" && father != "flange[0]" && steps <= placed.size()) {
      const auto next = placed.find(tool ? "tool " + father : father);
      if (next == placed.end()) break;
      whole = compose(next->second.father_T_frame, whole);
      father = next->second.father;
      ++steps;
    }
    const std::string name = tool ? key.substr(5) : key;
    (tool ? out.frames.tools : out.frames.frames)[name] = whole;
    if (!father.empty() && father != "world[0]" && father != "flange[0]") out.frames.refused[name] = "it stands on " + father + ", which is not in this file";
  }
  const Frame<double> none = frame_of(Pose<double>{{1, 0, 0, 0}, {0, 0, 0}});
  out.frames.frames["world[0]"] = none;
  const std::string tool = out.frames.tools.size() == 1 ? out.frames.tools.begin()->first : unknown_name;
  out.frames.tools["flange[0]"] = none;
  for (ProgramPosition& position : read_val3(text, path)) {
    ProgramTarget target;
    target.position = std::move(position);
    if (target.position.kind == ProgramPositionKind::pose) {
      const std::string_view tag = tag_from(text, target.position.begin);
      target.frame = value_of(tag, "fatherId").empty() ? "world[0]" : value_of(tag, "fatherId");
      target.tool = tool;
      const std::string shoulder = value_of(tag, "shoulder"), elbow = value_of(tag, "elbow"), wrist = value_of(tag, "wrist");
      // ssame, sfree and the like state nothing: the solution nearest to the target before.
      if (shoulder == "righty" || shoulder == "lefty") target.stated.rear = shoulder == "lefty";
      if (elbow == "epositive" || elbow == "enegative") target.stated.lower = elbow == "enegative";
      if (wrist == "wpositive") target.stated.reading[4] = wrist_positive;
      if (wrist == "wnegative") target.stated.reading[4] = wrist_negative;
    }
    out.targets.push_back(std::move(target));
  }
  return out;
}

}  // namespace mdhcal::offline
