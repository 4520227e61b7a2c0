// SPDX-License-Identifier: MIT
// Private to lib/src; include after real.hpp.
#pragma once

#include "mdhcal/compensator.hpp"
#include "number/real.hpp"

namespace mdhcal {
namespace {

// Storage that was not initialised, or of the other precision, holds another number, save with a chance of 2^-32.
constexpr std::uint32_t compensator_mark = sizeof(Real) == sizeof(double) ? 0xC45A7E19U : 0x91E3D60BU;

inline bool valid(const Compensator<Real>& c) { return c.mark == compensator_mark && c.ticks_done <= c.ticks_total; }

}  // namespace
}  // namespace mdhcal
