// SPDX-License-Identifier: MIT
// Private to lib/src.
#pragma once

#include "mdhcal/inverse.hpp"

namespace mdhcal {

/// Whether tick() would take the options and the target.
bool tick_valid(const Arm<double>& arm, const TickOptions<double>& options, const Pose<double>& target) noexcept;
bool tick_valid(const Arm<float>& arm, const TickOptions<float>& options, const Pose<float>& target) noexcept;

}  // namespace mdhcal
