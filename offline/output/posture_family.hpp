// SPDX-License-Identifier: MIT
#pragma once

#include "mdhcal/blob.hpp"

namespace mdhcal::offline {

/// The family of a valid nominal geometry, as find_solutions() judges it (family_of() in mdhcal/solutions.hpp): one judgement,
/// so that what the blob declares is what the controller does. Independent of the readings.
ArmFamily posture_family(const Geometry& nominal);

}  // namespace mdhcal::offline
