// SPDX-License-Identifier: MIT
// Private to lib/src.
#pragma once

#include "mdhcal/inverse.hpp"

namespace mdhcal {

/// Refines starting joints until they meet the target, without step or joint limits. Returns whether they do; q is then
/// the refined joints, else anything valid. The options' posture is not used.
bool refine(const Arm<double>& arm, const TickOptions<double>& options, const Frame<double>& target,
            double* q) noexcept;
bool refine(const Arm<float>& arm, const TickOptions<float>& options, const Frame<float>& target, float* q) noexcept;

/// Whether tick() would take the options and the target.
bool tick_valid(const Arm<double>& arm, const TickOptions<double>& options, const Pose<double>& target) noexcept;
bool tick_valid(const Arm<float>& arm, const TickOptions<float>& options, const Pose<float>& target) noexcept;

}  // namespace mdhcal
