// SPDX-License-Identifier: MIT
// What `forward`, `inverse` and `correct` read and print: tables of joints and of poses.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "offline/robot/robot.hpp"

namespace mdhcal::offline {

struct JointRow {
  std::string id;  ///< `id`, else the row's number from 1
  Joints q{};
};

struct PoseRow {
  std::string id;
  Pose<double> pose{};
  std::optional<Joints> seed;  ///< `s1..sN`, where the row has them
};

template <class Row>
struct Table {
  std::vector<Row> rows;
  std::vector<std::string> notes;  ///< ignored columns, to be said once
};

/// `q1..qN` and optionally `id`; degrees and millimetres unless a suffix says otherwise. Throws InputError.
Table<JointRow> read_joint_file(const std::string& path, const Geometry& geometry);

/// `x,y,z` with `qw,qx,qy,qz`, `rx,ry,rz` or the columns of the convention `rotation` names (rotation_columns.hpp),
/// optionally `id` and a seed `s1..sN`; millimetres and degrees unless a suffix says otherwise. Throws InputError.
Table<PoseRow> read_pose_file(const std::string& path, const Geometry& geometry, const std::string& rotation = "");

/// "PREFIX1_deg,PREFIX2_mm,...": the header of N joints.
std::string joint_header(const Geometry& geometry, const std::string& prefix);
/// The readings in the header's units, each behind a comma.
std::string joint_fields(const Geometry& geometry, const double* q);
/// A field of a table: in quotes where it needs them, with an apostrophe before what a spreadsheet would compute (it begins with =,
/// +, - or @ and is no number), and with control characters made visible (printable()).
std::string csv_field(const std::string& text);
/// 17 significant digits.
std::string csv_number(double value);

}  // namespace mdhcal::offline
