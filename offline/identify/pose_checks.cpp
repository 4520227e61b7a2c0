// SPDX-License-Identifier: MIT
#include "offline/identify/pose_checks.hpp"

#include <Eigen/SVD>

#include <algorithm>
#include <cmath>

#include "mdhcal/kinematics.hpp"
#include "offline/base/error.hpp"
#include "offline/base/sentences.hpp"
#include "offline/identify/registration.hpp"
#include "offline/robot/units.hpp"
#include "offline/robot/vectors.hpp"

namespace mdhcal::offline {

void check_poses(const Dataset& data, const std::vector<std::size_t>& rows, const Layout& layout) {
  std::size_t scalars = 0;
  for (std::size_t row : rows) scalars += residual_count(data.rows[row].kind);
  if (rows.empty()) throw InputError(data.path, 0, 0, "There is no row to identify from.");
  const std::size_t frames = layout.frame_columns();
  if (scalars < frames || scalars == 0) {
    throw InputError(data.path, data.rows[rows.back()].line, 0,
                     "Found " + std::to_string(scalars) + " scalar measurements in " + std::to_string(rows.size()) +
                         " rows; expected at least " + std::to_string(frames) +
                         ", the number of unknowns of the base frame and the targets.");
  }

  double widest = 0.0;
  for (std::size_t row : rows) {
    for (std::size_t j = 0; j < data.joint_count; ++j) {
      widest = std::max(widest, std::fabs(data.rows[row].q[j] - data.rows[rows.front()].q[j]));
    }
  }
  // An encoder's own steps are of some microradians; nobody measures twice with less than this between (rad or m).
  constexpr double same_readings = 1e-4;
  if (widest < same_readings) {
    throw InputError(data.path, data.rows[rows.back()].line, 0,
                     "All " + std::to_string(rows.size()) +
                         " poses have the same joint readings; expected different poses. Move every joint between "
                         "the measurements, and check that the joint columns are the ones that change.");
  }
  Vector3 first = data.rows[rows.front()].position_m;
  double spread = 0.0;
  bool positions = false;
  for (std::size_t row : rows) {
    if (data.rows[row].kind == MeasurementKind::distance) continue;
    if (!positions) first = data.rows[row].position_m;
    positions = true;
    spread = std::max(spread, norm(minus(data.rows[row].position_m, first)));
  }
  // A tracker's own noise is some micrometres: points within one are one reading, copied.
  constexpr double same_point_m = 1e-6;
  if (positions && rows.size() > 2 && spread < same_point_m) {
    throw InputError(data.path, data.rows[rows.front()].line, 0,
                     "All measured positions are the same point although the joints move; expected a position a pose. "
                     "The tracker recorded nothing new.");
  }
}

std::string spread_of_poses(const Robot& robot, const Dataset& data, const std::vector<std::size_t>& rows) {
  Vector3 middle{};
  std::vector<Vector3> points;
  for (const std::size_t row : rows) {
    if (data.rows[row].kind == MeasurementKind::distance) continue;
    points.push_back(data.rows[row].position_m);
    middle = plus(middle, points.back());
  }
  std::string out;
  if (points.size() >= 3) {
    Eigen::MatrixXd away(static_cast<Eigen::Index>(points.size()), 3);
    for (std::size_t i = 0; i < points.size(); ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        away(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) =
            1e3 * (points[i][k] - middle[k] / static_cast<double>(points.size()));
      }
    }
    const Eigen::VectorXd s = Eigen::BDCSVD<Eigen::MatrixXd>(away).singularValues() / std::sqrt(static_cast<double>(points.size()));
    out = "The points spread by " + number(s(0)) + ", " + number(s(1)) + " and " + number(s(2)) + " mm along their principal axes";
  }
  Arm<double> arm{};
  if (make_arm(robot.geometry, arm) != Status::ok) return out + ".";
  Frame<double> reference{};
  double turned = 0.0;
  bool seen = false;
  for (const std::size_t row : rows) {
    Pose<double> pose{};
    if (forward(arm, data.rows[row].q.data(), pose) != Status::ok) continue;
    const Frame<double> frame = frame_of(pose);
    if (!seen) reference = inverted(frame);
    seen = true;
    turned = std::max(turned, norm(log_of_rotation(compose(reference, frame))));
  }
  return out + (out.empty() ? "The flange turns" : ", and the flange turns") + " by at most " + number(turned * deg_per_rad, 2) +
         " degrees from its first orientation.";
}

std::vector<std::string> targets_on_last_axis(const Estimate& estimate, const Dataset& data) {
  std::vector<std::string> out;
  const std::int32_t n = estimate.geometry.joint_count;
  if (estimate.geometry.joint[n - 1].kind != JointKind::revolute) return out;
  // The last axis in the flange frame: beta turns it about y, the flange transform moves it.
  const Frame<double> last_T_flange = frame_of(estimate.geometry.last_T_flange);
  const Frame<double> beta = rotation_about({0.0, estimate.geometry.link[n - 1].beta_rad, 0.0}, {0.0, 0.0, 0.0});
  for (std::size_t t = 0; t < estimate.flange_p_m.size(); ++t) {
    const Vector3 p = transform(compose(beta, last_T_flange), estimate.flange_p_m[t]);
    const double radius_mm = 1e3 * std::hypot(p[0], p[1]);
    if (radius_mm >= 1.0) continue;
    const std::string word = t < data.targets.size() && !data.targets[t].empty() ? " " + data.targets[t] : "";
    out.push_back("Target" + word + " lies " + number(radius_mm, 3) + " mm from the axis of joint " +
                  std::to_string(n) +
                  ": turning that joint hardly moves it, and theta" + std::to_string(n) + " and alpha" +
                  std::to_string(n) + " are told badly or not at all. Put the reflector off the axis.");
  }
  return out;
}

}  // namespace mdhcal::offline
