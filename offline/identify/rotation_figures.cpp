// SPDX-License-Identifier: MIT
#include "offline/identify/rotation_figures.hpp"

#include "offline/base/sentences.hpp"
#include "offline/robot/units.hpp"
#include "offline/robot/vectors.hpp"

namespace mdhcal::offline {

Vector3 rotation_error_rad(const MeasurementModel& model, const Dataset& data, std::size_t row) {
  double residual_mm[max_row_residuals];
  (void)model.residual(data, row, residual_mm);
  return {residual_mm[3] / data.rotation_lever_mm, residual_mm[4] / data.rotation_lever_mm,
          residual_mm[5] / data.rotation_lever_mm};
}

RotationFigures rotation_figures(const Estimate& before, const Estimate& after, const Dataset& data,
                                 const std::vector<std::size_t>& rows) {
  const MeasurementModel nominal(before);
  const MeasurementModel corrected(after);
  std::vector<double> before_deg;
  std::vector<double> after_deg;
  for (const std::size_t row : rows) {
    if (data.rows[row].kind != MeasurementKind::pose) continue;
    before_deg.push_back(deg_per_rad * norm(rotation_error_rad(nominal, data, row)));
    after_deg.push_back(deg_per_rad * norm(rotation_error_rad(corrected, data, row)));
  }
  return {statistics(before_deg), statistics(after_deg)};
}

std::string rotation_sentence(const RotationFigures& figures, const std::string& on) {
  if (figures.after.count == 0) return {};
  return "Rotations of " + std::to_string(figures.after.count) + " " + on + " full poses: mean error " +
         number(figures.after.mean) + " degrees, maximum " + number(figures.after.max) + " degrees; nominal " +
         number(figures.before.mean) + " and " + number(figures.before.max) + " degrees.";
}

}  // namespace mdhcal::offline
