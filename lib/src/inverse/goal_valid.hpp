// SPDX-License-Identifier: MIT
// Private to lib/src.
#pragma once

#include "mdhcal/inverse.hpp"

namespace mdhcal {

/// Whether the tolerances and weights are positive and at most 1e6, and the task is one.
bool goal_valid(const GoalOptions<double>& goal) noexcept;
bool goal_valid(const GoalOptions<float>& goal) noexcept;

/// Whether the pose is finite, within max_target_m, and its quaternion a unit one to 1e-6 (float 1e-5).
bool target_valid(const Pose<double>& target) noexcept;
bool target_valid(const Pose<float>& target) noexcept;

}  // namespace mdhcal
