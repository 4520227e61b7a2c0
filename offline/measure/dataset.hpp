// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "offline/robot/robot.hpp"

namespace mdhcal::offline {

/// What a row of a measurement file states about its target.
enum class MeasurementKind : std::int32_t {
  position,  ///< x, y, z of a target point
  pose,      ///< x, y, z and a rotation of the target frame (its rotation is the flange's)
  distance,  ///< length between the target points of two poses (ball bar, draw wire): columns `distance`, `to`
  joints,    ///< nothing: the row only states the joints of a distance's other end
};

/// One row, in SI units.
struct Measurement {
  std::string id;                 ///< `id`, else the row's number from 1
  std::uint32_t group = 0;        ///< index into Dataset::groups
  std::uint32_t target = 0;       ///< index into Dataset::targets
  MeasurementKind kind = MeasurementKind::position;
  Joints q{};
  std::array<double, 3> position_m{};          ///< measured target point, tracker frame
  std::array<double, 4> quaternion{1, 0, 0, 0};///< measured rotation (pose only)
  double distance_m = 0;                       ///< (distance only)
  std::int64_t other_row = -1;                 ///< the other end's row (distance only; -1: a fixed point, see x, y, z)
  std::array<double, 3> sigma_m{};             ///< standard deviation in x, y, z; 0 where none is given
  long line = 0;                               ///< line in the file, for messages
};

/// A measurement file: rows in file order.
struct Dataset {
  std::string path;
  std::size_t joint_count = 0;
  std::vector<Measurement> rows;
  std::vector<std::string> groups;    ///< names, in order of first appearance; rows without `group` are each their own
  std::vector<std::string> targets;   ///< names, in order of first appearance; one unnamed ("") without the column
  /// Commanded readings, one row each, if the file has `q1_cmd` ...; else empty.
  std::vector<Joints> commanded;
  std::vector<double> temperature;    ///< if the column is there, else empty
  std::vector<std::string> direction; ///< likewise: direction of approach
  std::vector<std::string> joint_columns; ///< names of the columns of the readings, as in the header
  bool angles_stated = false;         ///< the names of the joints' columns state their unit
  bool lengths_stated = false;        ///< likewise x, y, z or distance
  std::vector<std::string> notes;     ///< ignored columns and the like, to be said once
  std::string digest_sha256;          ///< of the file's bytes, lower-case hexadecimal
};

/// How a row is named to the user: its id, or id/target where there are several targets.
std::string row_name(const Dataset& data, const Measurement& row);

/// Reads a measurement file (CSV, docs/file-formats.md). Throws InputError naming file, line, column, found and expected.
/// `progress`, if given, is called now and then with the kilobytes read and all of them.
Dataset read_dataset(const std::string& path, const Robot& robot,
                     const std::function<void(std::size_t, std::size_t)>& progress = {});
Dataset parse_dataset(const std::string& text, const std::string& path, const Robot& robot);

}  // namespace mdhcal::offline
