// SPDX-License-Identifier: MIT
#include "mdhcal/pose.hpp"

#include "arm/rotation.hpp"
#include "number/compare.hpp"
#include "number/real.hpp"

namespace mdhcal {

namespace {

bool valid(const Pose<Real>& pose) {
  constexpr Real tolerance = sizeof(Real) == sizeof(double) ? Real(1e-6) : Real(1e-5);
  const Real* c = pose.quaternion;
  for (int k = 0; k < 4; ++k) {
    if (!within(Real{-2}, c[k], Real{2})) return false;
  }
  const Real square = (c[0] * c[0] + c[1] * c[1]) + (c[2] * c[2] + c[3] * c[3]);
  if (!(magnitude(square - Real{1}) <= Real{2} * tolerance)) return false;
  for (int k = 0; k < 3; ++k) {
    if (!within(Real(-1e9), pose.position_m[k], Real(1e9))) return false;
  }
  return true;
}

}  // namespace

Status multiply(const Pose<Real>& a_T_b, const Pose<Real>& b_T_c, Pose<Real>& a_T_c) noexcept {
  if (!valid(a_T_b) || !valid(b_T_c)) return Status::bad_input;
  Frame<Real> a, b, c;
  to_frame(a_T_b, a);
  to_frame(b_T_c, b);
  multiply(a, b, c);
  to_pose(c, a_T_c);
  return Status::ok;
}

Status invert(const Pose<Real>& a_T_b, Pose<Real>& b_T_a) noexcept {
  if (!valid(a_T_b)) return Status::bad_input;
  Frame<Real> forth, back;
  to_frame(a_T_b, forth);
  invert(forth, back);
  to_pose(back, b_T_a);
  return Status::ok;
}

}  // namespace mdhcal
