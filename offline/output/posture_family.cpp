// SPDX-License-Identifier: MIT
#include "offline/output/posture_family.hpp"

#include "mdhcal/solutions.hpp"

namespace mdhcal::offline {

PostureFamily posture_family(const Geometry& nominal) {
  Arm<double> arm{};
  if (make_arm(nominal, arm) != Status::ok) return PostureFamily::general;
  switch (family(arm)) {
    case Family::parallel: return PostureFamily::parallel_axes;
    case Family::spherical_wrist: return PostureFamily::spherical_wrist;
    case Family::general: break;
  }
  return PostureFamily::general;
}

}  // namespace mdhcal::offline
