// SPDX-License-Identifier: MIT
#include "offline/measure/rotation_columns.hpp"

#include <cmath>

#include "offline/robot/rotation.hpp"

namespace mdhcal::offline {

RotationColumns::RotationColumns(const Csv& csv, Columns& columns, const Unit& angle)
    : csv_(csv), columns_(columns.find_all({"qw", "qx", "qy", "qz"}, plain_number)) {
  const std::vector<Column> vector = columns.find_all({"rx", "ry", "rz"}, angle);
  if (!columns_.empty() && !vector.empty()) {
    csv_.fail_header(vector[0].index, "found beside qw, qx, qy, qz; expected one kind of rotation.");
  }
  if (columns_.empty()) columns_ = vector;
}

bool RotationColumns::empty() const {
  for (const Column& column : columns_) {
    if (!column.empty(csv_)) return false;
  }
  return true;
}

std::array<double, 4> RotationColumns::read() const {
  if (columns_.size() == 3) return quaternion_of({columns_[0].read(csv_), columns_[1].read(csv_), columns_[2].read(csv_)});
  std::array<double, 4> q{};
  double norm = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    q[k] = columns_[k].read(csv_, 2.0);
    norm += q[k] * q[k];
  }
  norm = std::sqrt(norm);
  // Files carry a few digits; more than this is no rounding.
  if (!(std::abs(norm - 1.0) <= 1e-3)) {
    csv_.fail(columns_[0].index, "found a quaternion of norm " + shortest_decimal(norm) + "; expected a norm of 1.");
  }
  if (q[0] < 0) norm = -norm;
  for (double& c : q) c /= norm;
  return q;
}

}  // namespace mdhcal::offline
