// SPDX-License-Identifier: MIT
// The positions in a robot program or a log of joint states, each number with its place in the text, so that it can be
// read here and written back elsewhere.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace mdhcal::offline {

enum class ProgramLanguage : std::int32_t {
  krl,          ///< KUKA .dat, .src: E6AXIS, AXIS, E6POS, POS, FRAME
  rapid,        ///< ABB .mod: jointtarget, robtarget
  fanuc_ls,     ///< FANUC .LS: the section /POS
  inform,       ///< Yaskawa .JBI: the section //POS
  urscript,     ///< Universal Robots: [six joints], p[pose] in moves and assignments
  val3,         ///< Staubli .dtx: jointRx, pointRx
  joint_state,  ///< sensor_msgs/JointState messages as YAML documents
};

/// A number of the text.
struct ProgramNumber {
  double value = 0;
  std::size_t begin = 0, end = 0;  ///< bytes [begin, end) of the text; empty where the text leaves the number out (VAL3: zero)
};

enum class ProgramPositionKind : std::int32_t { joints, pulses, pose };

struct ProgramPosition {
  std::string name;
  ProgramPositionKind kind = ProgramPositionKind::joints;
  /// Joints in order [deg], JointState and URScript [rad], further axes behind them; pulses likewise. A pose:
  /// x, y, z [mm] (URScript [m]) and the rotation's three or four numbers as the language writes them.
  std::vector<ProgramNumber> numbers;
  std::vector<std::string> joint_names;  ///< (joint_state only) one a number
  std::optional<double> time_s;          ///< (joint_state only) of the header's stamp
  bool radians = false;                  ///< of joints
  std::size_t begin = 0;                 ///< where the position's text starts
};

/// The language of a text by the words that only it has; nothing for a table.
std::optional<ProgramLanguage> program_language(std::string_view text);

/// Its name for messages: "a KRL file", ...
std::string language_name(ProgramLanguage language);

/// The positions in the order of the text. What stands in comments, strings and other declarations is passed over.
/// Throws InputError naming line and column where a position breaks off or holds something else than a number.
std::vector<ProgramPosition> read_program(std::string_view text, ProgramLanguage language, const std::string& path);

/// The line, from 1, in which a byte of the text stands.
long line_of(std::string_view text, std::size_t at);

}  // namespace mdhcal::offline
