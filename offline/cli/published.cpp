// SPDX-License-Identifier: MIT
#include "offline/cli/published.hpp"

#include <cmath>

#include "offline/measure/columns.hpp"
#include "published_li2022.hpp"

namespace mdhcal::offline {

namespace {

bool same_links(const Robot& a, const Robot& b) {
  if (a.geometry.joint_count != b.geometry.joint_count) return false;
  // Decimal figures read in degrees or radians, millimetres or metres differ by rounding only.
  constexpr double rounding = 1e-9;
  for (std::int32_t i = 0; i < a.geometry.joint_count; ++i) {
    const Link& p = a.geometry.link[i];
    const Link& q = b.geometry.link[i];
    for (const double difference : {p.alpha_rad - q.alpha_rad, p.a_m - q.a_m, p.theta_rad - q.theta_rad, p.d_m - q.d_m,
                                    p.beta_rad - q.beta_rad}) {
      if (std::fabs(difference) > rounding) return false;
    }
  }
  return true;
}

}  // namespace

std::vector<PublishedFigures> published_figures(const Robot& robot) {
  if (!same_links(robot, parse_robot(published_li2022_robot, "robot.toml of li2022"))) return {};
  Csv csv(published_li2022_figures, "published.csv of li2022", "published figures");
  Columns columns(csv);
  const Column method = columns.find_text("method");
  const Column max = columns.find_text("max_mm"), mean = columns.find_text("mean_mm"), sd = columns.find_text("sd_mm");
  std::vector<PublishedFigures> out;
  while (csv.next()) {
    out.push_back({std::string(csv.field(method.index)), csv.number(max.index), csv.number(mean.index),
                   csv.number(sd.index)});
  }
  return out;
}

}  // namespace mdhcal::offline
