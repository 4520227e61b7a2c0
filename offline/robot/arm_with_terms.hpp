// SPDX-License-Identifier: MIT
#pragma once

#include <memory>

#include "mdhcal/arm.hpp"

namespace mdhcal::offline {

/// An arm with its transmission. Copies share the table that the arm refers to.
template <class Real>
struct ArmWithTerms {
  std::shared_ptr<JointFunctionTable> table;
  Arm<Real> arm{};
};

/// Returns as make_arm() with a transmission; `to` is untouched unless ok.
template <class Real>
Status prepare(const Geometry& geometry, const Transmission& transmission, ArmWithTerms<Real>& to) {
  ArmWithTerms<Real> made{std::make_shared<JointFunctionTable>(), {}};
  const Status status = make_arm(geometry, transmission, *made.table, made.arm);
  if (status != Status::ok) return status;
  if (made.arm.terms.functions != nullptr) make_table(transmission, *made.table);
  to = made;
  return status;
}

}  // namespace mdhcal::offline
