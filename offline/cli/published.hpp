// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "offline/robot/robot.hpp"

namespace mdhcal::offline {

/// What a publication reports for one method [mm].
struct PublishedFigures {
  std::string method;
  double max_mm = 0, mean_mm = 0, sd_mm = 0;
};

/// (Li 2022, Table 9) if `robot` has the geometry of (Li 2022, Table 1), whatever its name; else empty.
std::vector<PublishedFigures> published_figures(const Robot& robot);

}  // namespace mdhcal::offline
