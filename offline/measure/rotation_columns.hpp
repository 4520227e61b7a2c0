// SPDX-License-Identifier: MIT
// Which columns of a table state a rotation, and how.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "offline/measure/columns.hpp"
#include "offline/measure/rotations.hpp"

namespace mdhcal::offline {

/// The columns of a rotation. By themselves `qw,qx,qy,qz` (in any order) and the rotation vector `rx,ry,rz` are read.
/// With a convention named (`--rotation`) any one of these groups is:
///   three numbers  rx,ry,rz | roll,pitch,yaw | ez,ey,ex (each the turn about its axis), a,b,c | w,p,r | o,a,t | u,v,w | a,e,r |
///                  e1,e2,e3 (in the convention's order);
///   four numbers   qw,qx,qy,qz | q0,q1,q2,q3 | q1,q2,q3,q4, in the convention's order.
/// "none" reads no rotation. A group that is there and not read is refused with a question, never ignored.
class RotationColumns {
 public:
  /// `named` is the convention's name, "none", or empty. Refuses a table with two groups, or with one of the first two
  /// in part. Throws InputError if the name is unknown or no group fits it.
  RotationColumns(const Csv& csv, Columns& columns, const Unit& angle, const std::string& named);

  bool found() const { return !columns_.empty(); }
  /// Whether the current row leaves all of them empty.
  bool empty() const;
  /// The numbers of the current row, [rad] or plain, in the columns' order; the fourth is 0 where there are three.
  /// InputError if a quaternion's norm is further from 1 than the rounding of a few digits.
  std::array<double, 4> numbers() const;

  const RotationConvention& convention() const { return convention_; }
  bool by_axis() const { return by_axis_; }        ///< the columns name their axes: x, y, z
  bool unit_stated() const { return unit_stated_; }///< every angle's column states its unit

  /// The unit quaternion w, x, y, z, w >= 0, of numbers().
  std::array<double, 4> quaternion(const std::array<double, 4>& numbers) const {
    return quaternion_from(convention_, ordered(convention_, by_axis_, numbers));
  }

 private:
  void find_unnamed(Columns& columns, const Unit& angle);
  void find_named(Columns& columns, const Unit& angle);

  const Csv& csv_;
  std::vector<Column> columns_;
  RotationConvention convention_;
  bool by_axis_ = false;
  bool unit_stated_ = true;
};

}  // namespace mdhcal::offline
