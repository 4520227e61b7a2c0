// SPDX-License-Identifier: MIT
// What a tracker's export or a log of joints states, row by row, in SI units.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "offline/import/profile.hpp"
#include "offline/robot/robot.hpp"

namespace mdhcal::offline {

struct SourceRow {
  std::map<std::string, std::string> parts;  ///< of the point's name: "id", "group", "target", "collection"; those stated
  std::string point;                    ///< which of several points of one row, "" for one
  std::size_t index = 0;                ///< the row's number in its file, from 0; the same for the points of one row
  long line = 0;
  std::optional<double> time_s;
  std::optional<Vector3> position_m;    ///< empty where nothing was measured, or of a log of joints
  std::optional<std::array<double, 4>> quaternion;  ///< tracker_R_probe: w, x, y, z, w >= 0
  std::optional<Vector3> sigma_m;
  std::optional<Joints> joints;
  std::map<std::string, std::string> extra;  ///< temperature, direction, payload: as they stand there
};

struct SourceTable {
  std::string path;
  std::vector<SourceRow> rows;
  std::size_t row_count = 0;            ///< of the file, with those in which nothing was measured
  std::vector<std::string> points;      ///< names of the points of a row, in order; empty for one
  bool measures = false;                ///< there are columns of positions
  bool has_joints = false;
  std::vector<std::string> notes;       ///< to be told once: how it was read, what was left out
};

/// Reads a file: a table, or a robot program of which the joint positions are taken (program.hpp). `profile` is what is stated
/// of it; where it has no name, a built-in profile that recognises the file is taken. `pulses_per_unit`: a joint's pulses
/// per degree (or mm), for programs that state pulses.
/// Throws InputError naming file, line and column, or asking what the file does not tell, with its first lines.
SourceTable read_source(const std::string& bytes, const std::string& path, const Profile& profile, const Robot& robot,
                        const std::vector<double>& pulses_per_unit);

}  // namespace mdhcal::offline
