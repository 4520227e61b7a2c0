// SPDX-License-Identifier: MIT
// A program of somebody else: links the real-time library and the store, and needs nothing more.
#include <mdhcal/kinematics.hpp>
#include <mdhcal/port/store.hpp>

int main() {
  mdhcal::Geometry geometry = {};
  geometry.joint_count = 1;
  geometry.link[0].a_m = 0.5;
  geometry.joint[0].sign = 1;
  geometry.last_T_flange.quaternion[0] = 1.0;
  geometry.last_T_flange.position_m[0] = 0.25;
  mdhcal::Arm<double> arm = {};
  if (mdhcal::make_arm(geometry, arm) != mdhcal::Status::ok) return 1;
  const double q_rad[1] = {0.0};
  mdhcal::Pose<double> base_T_flange = {};
  if (mdhcal::forward(arm, q_rad, base_T_flange) != mdhcal::Status::ok) return 2;
  if (!(base_T_flange.position_m[0] >= 0.75 && base_T_flange.position_m[0] <= 0.75)) return 3;
  return mdhcal::slot_bytes({32, 8192, 2, 0xFF}) == 8192 ? 0 : 4;
}
