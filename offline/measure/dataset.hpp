// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "offline/measure/rotations.hpp"
#include "offline/robot/robot.hpp"

namespace mdhcal::offline {

/// What a row of a measurement file states about its target.
enum class MeasurementKind : std::int32_t {
  position,  ///< x, y, z of a target point
  pose,      ///< x, y, z and the rotation of a probe that is fixed to the flange there
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
  std::array<double, 4> quaternion{1, 0, 0, 0};///< measured rotation tracker_R_probe, w, x, y, z (pose only)
  std::array<double, 4> rotation_numbers{};    ///< as the row states it, [rad] or plain, in the columns' order (pose only)
  double distance_m = 0;                       ///< (distance only)
  std::int64_t other_row = -1;                 ///< the other end's row (distance only; -1: a fixed point, see x, y, z)
  std::array<double, 3> sigma_m{};             ///< standard deviation in x, y, z; 0 where none is given
  double sigma_rotation_rad = 0;               ///< of the rotation about any axis; 0 where none is given (pose only)
  long line = 0;                               ///< line in the file, for messages
};

/// How the rotations of a file were read (where it has any).
struct RotationReading {
  RotationConvention convention;
  bool by_axis = false;      ///< the columns are named by their axes, x, y, z
  bool unit_stated = true;   ///< by the columns' suffixes, or a quaternion
};

/// A measurement file: rows in file order.
struct Dataset {
  std::string path;
  std::size_t joint_count = 0;
  std::vector<Measurement> rows;
  std::vector<std::string> groups;    ///< names, in order of first appearance; rows without `group` are each their own
  std::vector<std::string> targets;   ///< names, in order of first appearance; one unnamed ("") without the column
  RotationReading rotation;
  /// A measured rotation counts like the displacement that it causes at this distance [mm], where no sigma_rotation is
  /// stated: a rotation error of 0.2 mrad, usual for a six-dimensional tracker target, then weighs like 0.02 mm.
  double rotation_lever_mm = 100.0;
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

/// The rotation of a full pose read in another convention, each number times `factor` (a unit's, for angles).
std::array<double, 4> rotation_read_as(const Dataset& data, const Measurement& row, const RotationConvention& convention,
                                       double factor = 1.0);
/// The same rows with their rotations read so.
Dataset with_rotations_read_as(Dataset data, const RotationConvention& convention, double factor = 1.0);

/// Reads a measurement file (CSV, docs/file-formats.md). `rotation` names the convention of its rotation columns, "none" leaves them
/// out, empty reads qw, qx, qy, qz or the rotation vector rx, ry, rz. Throws InputError naming file, line, column, found
/// and expected. `progress`, if given, is called now and then with the kilobytes read and all of them.
Dataset read_dataset(const std::string& path, const Robot& robot, const std::string& rotation = "",
                     const std::function<void(std::size_t, std::size_t)>& progress = {});
Dataset parse_dataset(const std::string& text, const std::string& path, const Robot& robot,
                      const std::string& rotation = "");

}  // namespace mdhcal::offline
