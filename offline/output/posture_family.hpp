// SPDX-License-Identifier: MIT
#pragma once

#include "mdhcal/blob.hpp"

namespace mdhcal::offline {

/// The family of a valid nominal geometry: six turning joints whose axes 4, 5 and 6 meet within 1 mm, or whose axes 2, 3
/// and 4 are parallel within 1 mrad; else general. Independent of the readings.
PostureFamily posture_family(const Geometry& nominal);

}  // namespace mdhcal::offline
