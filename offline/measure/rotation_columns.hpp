// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <vector>

#include "offline/measure/columns.hpp"

namespace mdhcal::offline {

/// The columns of a rotation: `qw,qx,qy,qz` or the rotation vector `rx,ry,rz`.
class RotationColumns {
 public:
  /// Refuses a table that has both, or one of them in part.
  RotationColumns(const Csv& csv, Columns& columns, const Unit& angle);

  bool found() const { return !columns_.empty(); }
  /// Whether the current row leaves all of them empty.
  bool empty() const;
  /// The unit quaternion w, x, y, z, w >= 0, of the current row; InputError if the norm is further from 1 than the
  /// rounding of a few digits.
  std::array<double, 4> read() const;

 private:
  const Csv& csv_;
  std::vector<Column> columns_;
};

}  // namespace mdhcal::offline
