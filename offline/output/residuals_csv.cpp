// SPDX-License-Identifier: MIT
#include "offline/output/residuals_csv.hpp"

#include <cstdio>

#include "offline/measure/joint_file.hpp"

namespace mdhcal::offline {

std::string residuals_csv(const Calibration& calibration) {
  std::string out =
      "id,target,split,outlier,before_x_mm,before_y_mm,before_z_mm,after_x_mm,after_y_mm,after_z_mm";
  const bool turned = calibration.train_rotation.after.count + calibration.test_rotation.after.count > 0;
  if (turned) {
    out += ",rotation_before_x_mrad,rotation_before_y_mrad,rotation_before_z_mrad,rotation_after_x_mrad,"
           "rotation_after_y_mrad,rotation_after_z_mrad";
  }
  out += '\n';
  const MeasurementModel before(calibration.start);
  const MeasurementModel after(calibration.estimate);
  const auto append = [&](const Vector3& v, double factor) {
    for (const double c : v) {
      char text[40];
      std::snprintf(text, sizeof text, ",%.9g", factor * c);
      out += text;
    }
  };
  for (const RowResult& r : calibration.rows) {
    const Dataset& data = r.test ? calibration.testing : calibration.training;
    const Measurement& m = data.rows[r.row];
    out += csv_field(m.id) + ',' + (data.targets.empty() ? std::string() : csv_field(data.targets[m.target]));
    out += r.test ? ",test," : ",train,";
    out += r.outlier ? "1" : "0";
    append(r.before_mm, 1.0);
    append(r.after_mm, 1.0);
    for (const MeasurementModel* model : {&before, &after}) {
      if (turned && m.kind == MeasurementKind::pose) append(rotation_error_rad(*model, data, r.row), 1e3);
      if (turned && m.kind != MeasurementKind::pose) out += ",,,";
    }
    out += '\n';
  }
  return out;
}

}  // namespace mdhcal::offline
