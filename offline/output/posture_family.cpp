// SPDX-License-Identifier: MIT
#include "offline/output/posture_family.hpp"

#include "mdhcal/solutions.hpp"

namespace mdhcal::offline {

ArmFamily posture_family(const Geometry& nominal) {
  Arm<double> arm{};
  return make_arm(nominal, arm) == Status::ok ? family_of(arm) : ArmFamily::general;
}

}  // namespace mdhcal::offline
