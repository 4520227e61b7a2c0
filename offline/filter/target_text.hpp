// SPDX-License-Identifier: MIT
// A robot program as the filter sees it: where the numbers of its targets stand, which frame and tool they are in, which moves use them.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "offline/filter/posture.hpp"
#include "offline/import/program.hpp"
#include "offline/measure/rotations.hpp"
#include "offline/robot/rotation.hpp"

namespace mdhcal::offline {

/// One of a program's flags that follow from the joints.
struct FlagNumber {
  ProgramNumber number;
  std::int32_t joint = 0;  ///< from 0
};

inline constexpr const char* unknown_name = "?";

struct ProgramTarget {
  ProgramPosition position;
  std::string frame, tool;        ///< keys of ProgramFrames; empty: the robot's base, the flange; unknown_name: to be asked for
  Configuration stated{};
  std::vector<FlagNumber> flags;  ///< RAPID cf1, cf4, cf6; KRL T; FANUC turns; Yaskawa's RCONF (the current state line)
  std::optional<std::size_t> letter{};  ///< FANUC: where the N or F of CONFIG stands
  std::optional<Joints> seed{};   ///< URScript: qnear
};

enum class MoveKind : std::int32_t { joint, line, circle };

struct ProgramMove {
  MoveKind kind = MoveKind::joint;
  std::size_t at = 0;                  ///< where its text starts
  std::vector<std::size_t> targets;    ///< numbers of the targets, the end last; empty if it goes to a computed one
};

/// What stays as it is, and why.
struct LeftOut {
  std::size_t at = 0;
  std::string why;
};

/// Frames (in the robot's base) and tools (in the flange) by name or number, and pulses of the joints.
struct ProgramFrames {
  std::map<std::string, Frame<double>> frames, tools;
  std::map<std::string, std::string> refused;  ///< names with which a pose is not known: a reason each
  std::vector<double> pulses_per_degree;
};

struct TargetText {
  ProgramLanguage language = ProgramLanguage::krl;
  std::vector<ProgramTarget> targets;
  std::vector<ProgramMove> moves;
  std::vector<LeftOut> left_out;
  ProgramFrames frames;
};

/// The replacement of bytes [begin, end) of the text.
struct Edit {
  std::size_t begin = 0, end = 0;
  std::string text;
  std::int32_t order = 0;  ///< of two at the same place
};

/// The targets of a program. `frames` are those that are stated beside it. Throws InputError naming line and column.
TargetText read_targets(std::string_view text, ProgramLanguage language, const std::string& path, const ProgramFrames& frames);

/// The edits of a target's flags for the joints that it now has, by the language's rules.
std::vector<Edit> flag_edits(std::string_view text, const TargetText& program, const ProgramTarget& target, const Joints& q);

/// The convention of rotations of a language.
const RotationConvention& rotation_of(ProgramLanguage language);
/// A frame from x, y, z [mm] and a rotation's numbers [deg, or a quaternion]; URScript: [m], [rad].
Frame<double> frame_from(ProgramLanguage language, const std::vector<double>& numbers);
/// And back.
std::vector<double> numbers_from(ProgramLanguage language, const Frame<double>& frame);

TargetText rapid_targets(std::string_view text, const std::string& path, const ProgramFrames& frames);
TargetText krl_targets(std::string_view text, const std::string& path);
TargetText fanuc_ls_targets(std::string_view text, const std::string& path);
TargetText inform_targets(std::string_view text, const std::string& path);
TargetText val3_targets(std::string_view text, const std::string& path);
TargetText urscript_targets(std::string_view text, const std::string& path);

/// The frames and tools that a RAPID module declares (tooldata, wobjdata).
ProgramFrames rapid_frames(std::string_view text, const std::string& path);
/// Those of a file beside the program: TOOL_DATA[1]={X 1,...}, "UFRAME 1 X 1 ...", "pulses per degree: ..."; RAPID: another module.
ProgramFrames read_frames(std::string_view text, ProgramLanguage language, const std::string& path);

/// In small letters: languages but URScript and VAL3 take names in both.
std::string small_letters(std::string_view text);

/// The name of a frame or tool that a number names.
std::string number_name(const ProgramNumber& number);

}  // namespace mdhcal::offline
