// SPDX-License-Identifier: MIT
// The library's inverses as the commands use them.
#pragma once

#include <vector>

#include "mdhcal/solutions.hpp"
#include "offline/robot/robot.hpp"

namespace mdhcal::offline {

/// Joints for a pose and what the library said of them.
struct Solved {
  Joints q{};
  Status status = Status::not_converged;
};

/// The joints that meet the pose from a seed near them: ticks of the library until one meets it, or none comes nearer.
Solved solve_from(const Arm<double>& arm, const Pose<double>& base_T_flange, const Joints& seed);

/// The same, and where that meets nothing the solution nearest to the seed, modulo full turns: a joint limit may stand between
/// the seed and a pose that a full turn away is met.
Solved solve_near(const Arm<double>& arm, const Pose<double>& base_T_flange, const Joints& seed);

/// The solution nearest to zero, without a seed; if there is none, where ticks from zero get to, with their status.
Solved solve_anew(const Arm<double>& arm, const Pose<double>& base_T_flange);

/// Every solution modulo full turns, nearest to zero first.
std::vector<Solved> solve_all(const Arm<double>& arm, const Pose<double>& base_T_flange);

}  // namespace mdhcal::offline
