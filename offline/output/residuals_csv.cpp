// SPDX-License-Identifier: MIT
#include "offline/output/residuals_csv.hpp"

#include <cstdio>

#include "offline/measure/joint_file.hpp"

namespace mdhcal::offline {

std::string residuals_csv(const Calibration& calibration) {
  std::string out =
      "id,target,split,outlier,before_x_mm,before_y_mm,before_z_mm,after_x_mm,after_y_mm,after_z_mm\n";
  for (const RowResult& r : calibration.rows) {
    const Dataset& data = r.test ? calibration.testing : calibration.training;
    const Measurement& m = data.rows[r.row];
    out += csv_field(m.id) + ',' + (data.targets.empty() ? std::string() : csv_field(data.targets[m.target]));
    out += r.test ? ",test," : ",train,";
    out += r.outlier ? "1" : "0";
    for (const Vector3* v : {&r.before_mm, &r.after_mm}) {
      for (double c : *v) {
        char text[40];
        std::snprintf(text, sizeof text, ",%.9g", c);
        out += text;
      }
    }
    out += '\n';
  }
  return out;
}

}  // namespace mdhcal::offline
