// SPDX-License-Identifier: MIT
#include "offline/simulate/family.hpp"


#include "offline/base/error.hpp"
#include "offline/robot/units.hpp"

namespace mdhcal::offline {

namespace {


struct Row {
  double alpha_deg, a_mm, theta_deg, d_mm, limit_deg;
};

struct Family {
  std::string name;
  std::vector<Row> rows;
};

// Round dimensions of the size of small industrial arms; no product is meant.
const std::vector<Family>& families() {
  static const std::vector<Family> table = {
      {"three-parallel",
       {{0, 0, 0, 90, 170}, {90, 0, 0, 110, 170}, {0, 430, 0, 0, 170}, {0, 400, 0, 0, 170}, {-90, 0, 0, 95, 170},
        {90, 0, 0, 85, 170}}},
      {"spherical-wrist",
       {{0, 0, 0, 450, 170}, {-90, 150, -90, 0, 120}, {0, 600, 0, 0, 130}, {-90, 120, 0, 640, 170}, {90, 0, 0, 0, 120},
        {-90, 0, 0, 100, 170}}},
      {"seven-joint",
       {{0, 0, 0, 340, 170}, {-90, 0, 0, 0, 120}, {90, 0, 0, 400, 170}, {90, 0, 0, 0, 120}, {-90, 0, 0, 400, 170},
        {-90, 0, 0, 0, 120}, {90, 0, 0, 126, 170}}},
      {"five-joint",
       {{0, 0, 0, 147, 165}, {90, 33, 90, 0, 90}, {0, 155, 0, 0, 140}, {0, 135, 0, 0, 100}, {90, 0, 0, 218, 165}}},
  };
  return table;
}

}  // namespace

const std::vector<std::string>& family_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> list;
    for (const Family& family : families()) list.push_back(family.name);
    return list;
  }();
  return names;
}

Robot family_robot(const std::string& name) {
  for (const Family& family : families()) {
    if (family.name != name) continue;
    Robot robot;
    robot.name = name;
    robot.path = name;
    robot.geometry.joint_count = static_cast<std::int32_t>(family.rows.size());
    robot.geometry.last_T_flange.quaternion[0] = 1;
    for (std::size_t i = 0; i < family.rows.size(); ++i) {
      const Row& row = family.rows[i];
      robot.geometry.link[i] = {row.alpha_deg * rad_per_deg, row.a_mm * 1e-3, row.theta_deg * rad_per_deg, row.d_mm * 1e-3, 0};
      Joint& joint = robot.geometry.joint[i];
      joint.sign = 1;
      joint.has_min = joint.has_max = 1;
      joint.max = row.limit_deg * rad_per_deg;
      joint.min = -joint.max;
      robot.nominal[i] = robot.geometry.link[i];
    }
    robot.tool_p_m = Vector3{0.06, 0.04, 0.08};
    return robot;
  }
  std::string known;
  for (const std::string& each : family_names()) known += (known.empty() ? "" : ", ") + each;
  throw InputError("there is no built-in arm \"" + name + "\"; expected one of " + known);
}

}  // namespace mdhcal::offline
