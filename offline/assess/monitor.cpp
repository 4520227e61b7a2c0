// SPDX-License-Identifier: MIT
#include "offline/assess/monitor.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "offline/base/distributions.hpp"
#include "offline/identify/registration.hpp"
#include "offline/robot/rotation.hpp"
#include "offline/robot/units.hpp"
#include "offline/robot/vectors.hpp"

namespace mdhcal::offline {

namespace {

std::string sentence_of(const MonitorResult& r) {
  char text[400];
  switch (r.condition) {
    case Condition::good:
      std::snprintf(text, sizeof text,
                    "No recalibration is due: mean error %.4f mm on %zu rows, %.4f mm at calibration; a mean square %.2f times "
                    "that at calibration or more comes by chance with p = %.2g.",
                    r.mean_mm, r.count, r.expected_mean_mm, r.ratio, r.p_value);
      break;
    case Condition::frame_moved:
      std::snprintf(text, sizeof text,
                    "The tracker or the base has moved by %.3f mm and %.4f deg: mean error %.4f mm (p = %.2g), but %.4f mm after the "
                    "best rigid motion (p = %.2g); register anew, the arm is as calibrated.",
                    r.shift_mm, r.turn_deg, r.mean_mm, r.p_value, r.refitted_mean_mm, r.refitted_p_value);
      break;
    case Condition::recalibrate:
      if (r.refitted_ratio > 0) {
        std::snprintf(text, sizeof text,
                      "Recalibration is due: mean error %.4f mm on %zu rows, %.4f mm at calibration (p = %.2g), and still %.4f mm "
                      "after the best rigid motion (p = %.2g).",
                      r.mean_mm, r.count, r.expected_mean_mm, r.p_value, r.refitted_mean_mm, r.refitted_p_value);
      } else {
        std::snprintf(text, sizeof text,
                      "Recalibration or a new registration is due: mean error %.4f mm on %zu rows, %.4f mm at calibration "
                      "(p = %.2g); with 4 rows or more the two could be told apart.",
                      r.mean_mm, r.count, r.expected_mean_mm, r.p_value);
      }
      break;
  }
  return text;
}

}  // namespace

MonitorResult monitor(const std::vector<Vector3>& predicted_m, const std::vector<Vector3>& measured_m,
                      double expected_mean_mm, std::size_t expected_count, double alpha) {
  MonitorResult out;
  out.count = predicted_m.size();
  out.expected_mean_mm = expected_mean_mm;
  const auto n = static_cast<double>(out.count);
  // The mean norm of three normal numbers of variance v is sqrt(8 v / pi) (Maxwell).
  const double variance = expected_mean_mm * expected_mean_mm * std::numbers::pi / 8;
  const double expected_freedom = 3 * static_cast<double>(expected_count);

  double squares = 0;
  for (std::size_t i = 0; i < out.count; ++i) {
    const double error = 1e3 * norm(minus(predicted_m[i], measured_m[i]));
    squares += error * error;
    out.mean_mm += error / n;
    out.max_mm = std::max(out.max_mm, error);
  }
  out.ratio = squares / (3 * n) / variance;
  out.p_value = f_upper_tail(out.ratio, 3 * n, expected_freedom);

  if (out.count >= 4) {
    const Frame<double> motion = rigid_fit(predicted_m, measured_m, {});
    double left = 0;
    Vector3 middle{};
    for (const Vector3& p : predicted_m) {
      for (std::size_t k = 0; k < 3; ++k) middle[k] += p[k] / n;
    }
    for (std::size_t i = 0; i < out.count; ++i) {
      const double error = 1e3 * norm(minus(transform(motion, predicted_m[i]), measured_m[i]));
      left += error * error;
      out.refitted_mean_mm += error / n;
    }
    out.refitted_ratio = left / (3 * n - 6) / variance;
    out.refitted_p_value = f_upper_tail(out.refitted_ratio, 3 * n - 6, expected_freedom);
    out.shift_mm = 1e3 * norm(minus(transform(motion, middle), middle));
    const Pose<double> turn = pose_of(motion);
    out.turn_deg = norm(rotation_vector_of({turn.quaternion[0], turn.quaternion[1], turn.quaternion[2], turn.quaternion[3]})) *
                   deg_per_rad;
  }
  if (out.p_value < alpha) {
    const bool motion_explains = out.count >= 4 && out.refitted_p_value >= alpha;
    out.condition = motion_explains ? Condition::frame_moved : Condition::recalibrate;
  }
  out.sentence = sentence_of(out);
  return out;
}

}  // namespace mdhcal::offline
