// SPDX-License-Identifier: MIT
// Private to lib/src; include after real.hpp. Rotation matrices and quaternions. Internal linkage throughout.
#pragma once

#include "mdhcal/arm.hpp"
#include "number/compare.hpp"
#include "number/real.hpp"

namespace mdhcal {

/// a_T_c = a_T_b b_T_c, into a place apart from both.
static inline void multiply(const Frame<Real>& a, const Frame<Real>& b, Frame<Real>& c) {
  const Frame<Real> right = b;
  for (int row = 0; row < 3; ++row) {
    const Real* r = a.rotation + 3 * row;
    Real* to = c.rotation + 3 * row;
    const Real* m = right.rotation;
    const Real* p = right.position_m;
    const Real x = r[0], y = r[1], z = r[2];
    to[0] = x * m[0] + y * m[3] + z * m[6];
    to[1] = x * m[1] + y * m[4] + z * m[7];
    to[2] = x * m[2] + y * m[5] + z * m[8];
    c.position_m[row] = a.position_m[row] + (x * p[0] + y * p[1] + z * p[2]);
  }
}

/// b_T_a, the inverse of a_T_b, into a place apart.
static inline void invert(const Frame<Real>& a, Frame<Real>& b) {
  for (int row = 0; row < 3; ++row) {
    Real sum = 0;
    for (int col = 0; col < 3; ++col) {
      b.rotation[3 * row + col] = a.rotation[3 * col + row];
      sum += a.rotation[3 * col + row] * a.position_m[col];
    }
    b.position_m[row] = -sum;
  }
}

/// The pose of a frame. The quaternion comes from the largest of the four squared components, so that no
/// cancellation is worse than a factor of four (Shepperd 1978), and is normalised, w >= 0.
static inline void to_pose(const Frame<Real>& frame, Pose<Real>& pose) {
  const Real* r = frame.rotation;
  const Real one = 1;
  Real q[4];
  const Real trace = r[0] + r[4] + r[8];
  if (trace >= r[0] && trace >= r[4] && trace >= r[8]) {
    q[0] = one + trace;
    q[1] = r[7] - r[5];
    q[2] = r[2] - r[6];
    q[3] = r[3] - r[1];
  } else if (r[0] >= r[4] && r[0] >= r[8]) {
    q[0] = r[7] - r[5];
    q[1] = one + r[0] - r[4] - r[8];
    q[2] = r[1] + r[3];
    q[3] = r[2] + r[6];
  } else if (r[4] >= r[8]) {
    q[0] = r[2] - r[6];
    q[1] = r[1] + r[3];
    q[2] = one - r[0] + r[4] - r[8];
    q[3] = r[5] + r[7];
  } else {
    q[0] = r[3] - r[1];
    q[1] = r[2] + r[6];
    q[2] = r[5] + r[7];
    q[3] = one - r[0] - r[4] + r[8];
  }
  const Real norm = square_root((q[0] * q[0] + q[1] * q[1]) + (q[2] * q[2] + q[3] * q[3]));
  const Real scale = q[0] < Real{0} ? -one / norm : one / norm;
  for (int k = 0; k < 4; ++k) pose.quaternion[k] = scale * q[k];
  for (int k = 0; k < 3; ++k) pose.position_m[k] = frame.position_m[k];
}

static inline Real dot(const Real* a, const Real* b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static inline void add_cross(const Real* a, const Real* b, Real scale, Real* sum) {
  sum[0] += scale * (a[1] * b[2] - a[2] * b[1]);
  sum[1] += scale * (a[2] * b[0] - a[0] * b[2]);
  sum[2] += scale * (a[0] * b[1] - a[1] * b[0]);
}

/// The frame of a pose whose quaternion is a unit one to within what the caller checked; it is normalised here.
static inline void to_frame(const Pose<Real>& pose, Frame<Real>& frame) {
  const Real* c = pose.quaternion;
  const Real scale = Real{2} / ((c[0] * c[0] + c[1] * c[1]) + (c[2] * c[2] + c[3] * c[3]));
  const Real x = scale * c[1];
  const Real y = scale * c[2];
  const Real z = scale * c[3];
  Real* r = frame.rotation;
  r[0] = Real{1} - (y * c[2] + z * c[3]);
  r[1] = x * c[2] - z * c[0];
  r[2] = x * c[3] + y * c[0];
  r[3] = x * c[2] + z * c[0];
  r[4] = Real{1} - (x * c[1] + z * c[3]);
  r[5] = y * c[3] - x * c[0];
  r[6] = x * c[3] - y * c[0];
  r[7] = y * c[3] + x * c[0];
  r[8] = Real{1} - (x * c[1] + y * c[2]);
  for (int k = 0; k < 3; ++k) frame.position_m[k] = pose.position_m[k];
}

}  // namespace mdhcal
