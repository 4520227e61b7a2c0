// SPDX-License-Identifier: MIT
#include "mdhcal/environment.hpp"

#include <float.h>

namespace mdhcal {

namespace {

// volatile: the processor must do it, not the compiler. The last bits of 1 +- a quarter of epsilon tell the four
// rounding modes apart.
template <class R>
bool sound(R smallest, R epsilon) {
  volatile R tiny = smallest;
  volatile R half = R(0.5);
  volatile R subnormal = tiny * half;
  if (!(subnormal > R(0))) return false;
  volatile R back = subnormal + subnormal;  // a flushed operand would give zero
  if (back < tiny || back > tiny) return false;
  volatile R one = R(1);
  volatile R quarter = epsilon * R(0.25);
  volatile R above = one + quarter;
  volatile R below = one - quarter * half;
  volatile R negative = -one - quarter;
  return !(above > one) && !(below < one) && !(negative < -one);
}

}  // namespace

Status check_environment() noexcept {
  return sound<float>(FLT_MIN, FLT_EPSILON) && sound<double>(DBL_MIN, DBL_EPSILON) ? Status::ok
                                                                                  : Status::bad_environment;
}

}  // namespace mdhcal
