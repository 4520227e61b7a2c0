// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "offline/robot/robot.hpp"

namespace mdhcal::offline {

/// One visit of a pose: the error of a target point, measured minus commanded [mm].
struct Visit {
  std::string pose;        ///< configuration, and target where there are several
  Vector3 error_mm{};
};

/// One pose after ISO 9283:1998, clauses 7.2.1 and 7.2.2, position part.
struct PoseTest {
  std::string pose;
  std::size_t visits = 0;
  double accuracy_mm = 0;       ///< AP: distance of the barycentre of the attained positions from the commanded one
  double repeatability_mm = 0;  ///< RP: mean distance from the barycentre plus three standard deviations; 0 for one visit
};

/// All poses, in order of first appearance. The commanded position of every visit of a pose is the same up to the
/// scatter of its readings, so errors stand for positions.
struct Iso9283 {
  std::vector<PoseTest> poses;
  std::size_t repeated = 0;               ///< poses with two visits or more
  std::size_t fewest_visits = 0;          ///< among those; the standard asks for 30
  double largest_accuracy_mm = 0;         ///< largest AP of any pose
  double largest_repeatability_mm = 0;    ///< largest RP of any repeated pose
};

Iso9283 iso9283(const std::vector<Visit>& visits);

}  // namespace mdhcal::offline
