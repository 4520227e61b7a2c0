// SPDX-License-Identifier: MIT
// A robot program for a controller that computes with the nominal geometry, rewritten so that the arm as it is reaches the poses
// that the program means:
//   base_T_flange = frame target tool^-1;  q_n = inverse of the nominal arm, in the program's configuration;
//   q_c = inverse of the arm as it is, from q_n;  filtered target = frame^-1 forward_nominal(q_c) tool.
// Nothing is linearised: what is left is the rounding of the program's digits.
#pragma once

#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "mdhcal/blob.hpp"
#include "offline/filter/target_text.hpp"

namespace mdhcal::offline {

struct FilterOptions {
  ProgramFrames frames;         ///< stated beside the program
  std::string tool, frame;      ///< for targets whose program states none: a name, or six or seven numbers; empty: ask
  bool keep_taught = false;     ///< joint targets stay as they are
  std::set<std::string> keep;   ///< and so do targets of these names
  double least_sag_m = 5e-5;    ///< lines that leave their straight by more are named: what arms repeat to [m]
};

/// A target or move to which a line of the report goes.
struct FilterNote {
  long line = 0;
  std::string text;
};

struct FilterResult {
  std::string text;                     ///< the program, filtered; empty unless `stopped` is
  std::size_t targets = 0, filtered = 0, flags_changed = 0;
  double most_moved_m = 0;              ///< the furthest that a flange was moved by the correction [m]
  double most_rounding_m = 0;           ///< how far at most the digits of the text leave the flange from the pose meant [m]
  std::vector<FilterNote> stopped;      ///< targets that cannot be met: there is no output then
  std::vector<FilterNote> notes;        ///< kept or computed targets, singular ones, lines with their sag
};

/// Filters a program. `blob` has passed the decoder. Throws InputError naming `path`, line and column where the program, a frame or
/// a tool cannot be understood.
FilterResult filter_program(std::string_view text, ProgramLanguage language, const std::string& path, const BlobContent& blob, const FilterOptions& options);

}  // namespace mdhcal::offline
