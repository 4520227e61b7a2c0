// SPDX-License-Identifier: MIT
#include "offline/filter/target_text.hpp"

#include <algorithm>
#include <cmath>

#include "offline/import/scanner.hpp"
#include "offline/measure/rotations.hpp"
#include "offline/robot/units.hpp"

namespace mdhcal::offline {

namespace {

// The turn of a reading in parts of `part_deg`: floor(q / part).
long floored(double q_rad, double part_deg, double shift_deg) {
  return static_cast<long>(std::floor((q_rad / one_degree_rad + shift_deg) / part_deg));
}

void put(std::vector<Edit>& edits, const ProgramNumber& number, long value) {
  const std::string written = std::to_string(value);
  // As it was written, "+1" or "1.0", where the value is the same.
  if (std::abs(number.value - static_cast<double>(value)) > 0) {
    edits.push_back({number.begin, number.end, written});
  }
}

// A state line of its own before the record, for records from here on, and the former one behind it.
void inform_flags(std::vector<Edit>& edits, std::string_view text, const ProgramTarget& target, const Joints& q) {
  if (target.flags.size() < 6) return;
  const auto far = [&](std::size_t j) { return std::abs(q[j]) >= 180 * one_degree_rad; };
  const bool flag[6] = {q[4] >= 0, *target.stated.lower, *target.stated.rear, far(3), far(5), far(0)};
  std::string before = "///RCONF ", now = before;
  bool changed = false;
  for (std::size_t k = 0; k < target.flags.size(); ++k) {
    const ProgramNumber& number = target.flags[k].number;
    const std::string stated(text.substr(number.begin, number.end - number.begin));
    const bool differs = k < 6 && flag[k] != (number.value > 0.5);
    changed = changed || differs;
    before += (k == 0 ? "" : ",") + stated;
    now += (k == 0 ? "" : ",") + (differs ? std::string(flag[k] ? "1" : "0") : stated);
  }
  if (!changed) return;
  const std::size_t begin = target.position.begin, line = text.find('\n', begin);
  const std::string end = line != std::string_view::npos && line > 0 && text[line - 1] == '\r' ? "\r\n" : "\n";
  edits.push_back({begin, begin, now + end, 1});
  if (line != std::string_view::npos) edits.push_back({line + 1, line + 1, before + end, 0});
}

}  // namespace

std::string small_letters(std::string_view text) {
  std::string small(text);
  for (char& c : small) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return small;
}

std::string number_name(const ProgramNumber& number) {
  // No controller counts its frames further.
  return std::abs(number.value) < 1e6 ? std::to_string(static_cast<long>(number.value)) : unknown_name;
}

TargetText read_targets(std::string_view text, ProgramLanguage language, const std::string& path, const ProgramFrames& frames) {
  TargetText out;
  switch (language) {
    case ProgramLanguage::krl: out = krl_targets(text, path); break;
    case ProgramLanguage::rapid: out = rapid_targets(text, path, frames); break;
    case ProgramLanguage::fanuc_ls: out = fanuc_ls_targets(text, path); break;
    case ProgramLanguage::inform: out = inform_targets(text, path); break;
    case ProgramLanguage::val3: out = val3_targets(text, path); break;
    case ProgramLanguage::urscript: out = urscript_targets(text, path); break;
    case ProgramLanguage::joint_state: Scanner(text, path).fail("Found JointState messages; expected a robot program.");
  }
  out.frames.frames.insert(frames.frames.begin(), frames.frames.end());
  out.frames.tools.insert(frames.tools.begin(), frames.tools.end());
  out.frames.refused.insert(frames.refused.begin(), frames.refused.end());
  out.frames.pulses_per_degree = frames.pulses_per_degree;
  return out;
}

std::vector<Edit> flag_edits(std::string_view text, const TargetText& program, const ProgramTarget& target, const Joints& q) {
  std::vector<Edit> edits;
  switch (program.language) {
    case ProgramLanguage::rapid:
      for (const FlagNumber& flag : target.flags) put(edits, flag.number, floored(q[static_cast<std::size_t>(flag.joint)], 90, 0));
      break;
    case ProgramLanguage::krl:
      if (!target.flags.empty()) {
        long turn = 0;
        for (std::size_t j = 0; j < 6; ++j) turn |= q[j] < 0 ? 1L << j : 0;
        put(edits, target.flags[0].number, turn);
      }
      break;
    case ProgramLanguage::fanuc_ls:
      for (const FlagNumber& flag : target.flags) put(edits, flag.number, floored(q[static_cast<std::size_t>(flag.joint)], 360, 180));
      if (target.letter) {
        const std::string letter(1, q[4] < 0 ? 'F' : 'N');
        if (text.substr(*target.letter, 1) != letter) edits.push_back({*target.letter, *target.letter + 1, letter});
      }
      break;
    case ProgramLanguage::inform: inform_flags(edits, text, target, q); break;
    default: break;
  }
  return edits;
}

const RotationConvention& rotation_of(ProgramLanguage language) {
  const auto named = [](const char* name) { return *rotation_convention(name); };
  static const RotationConvention krl = named("kuka"), rapid = named("quaternion"), fanuc = named("fanuc"), inform = named("yaskawa"), val3 = named("staubli"),
                                  ur = named("ur");
  switch (language) {
    case ProgramLanguage::krl: return krl;
    case ProgramLanguage::rapid: return rapid;
    case ProgramLanguage::fanuc_ls: return fanuc;
    case ProgramLanguage::inform: return inform;
    case ProgramLanguage::val3: return val3;
    default: return ur;
  }
}

Frame<double> frame_from(ProgramLanguage language, const std::vector<double>& numbers) {
  const RotationConvention& convention = rotation_of(language);
  const double length = language == ProgramLanguage::urscript ? 1 : 1e-3;
  const double angle = convention.form == RotationForm::euler ? one_degree_rad : 1;
  std::array<double, 4> rotation{};
  for (std::size_t k = 0; k < convention.count(); ++k) rotation[k] = numbers[3 + k] * angle;
  const std::array<double, 4> q = quaternion_from(convention, rotation);
  return frame_of(Pose<double>{{q[0], q[1], q[2], q[3]}, {numbers[0] * length, numbers[1] * length, numbers[2] * length}});
}

std::vector<double> numbers_from(ProgramLanguage language, const Frame<double>& frame) {
  const RotationConvention& convention = rotation_of(language);
  const double length = language == ProgramLanguage::urscript ? 1 : 1e-3;
  const double angle = convention.form == RotationForm::euler ? one_degree_rad : 1;
  const Pose<double> pose = pose_of(frame);
  const std::array<double, 4> rotation = numbers_of(convention, {pose.quaternion[0], pose.quaternion[1], pose.quaternion[2], pose.quaternion[3]});
  std::vector<double> numbers;
  for (const double p : pose.position_m) numbers.push_back(p / length);
  for (std::size_t k = 0; k < convention.count(); ++k) numbers.push_back(rotation[k] / angle);
  return numbers;
}

}  // namespace mdhcal::offline
