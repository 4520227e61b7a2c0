// SPDX-License-Identifier: MIT
// Private to lib/src; include after real.hpp. What is left between a frame and its target. Internal linkage throughout.
#pragma once

#include "mdhcal/inverse.hpp"
#include "number/real.hpp"
#include "arm/rotation.hpp"
#include "number/trigonometry.hpp"

namespace mdhcal {
namespace {

struct PoseError {
  Real vector[6];     ///< position [m], rotation vector in the base frame [rad]; what the task leaves free is zero
  Real position_m;    ///< norms
  Real rotation_rad;
};

/// The rotation vector whose sine times axis is `sine` and whose cosine is `cosine`, short of half a turn. At half a
/// turn the axis is lost and `fallback` (a unit vector) takes its place.
inline void rotation_vector(const Real* sine, Real cosine, const Real* fallback, Real* vector) {
  const Real square = dot(sine, sine);
  if (cosine > Real(0.98)) {
    // asin(s)/s to s^6: for the angles here its error is below the rounding of the sum.
    const Real factor = Real{1} + square * (Real{1} / Real{6} + square * (Real(0.075) + square * (Real{15} / Real{336})));
    for (int k = 0; k < 3; ++k) vector[k] = factor * sine[k];
    return;
  }
  const Real norm = square_root(square);
  const Real angle = arc_tangent(norm, cosine);
  const bool lost = !(norm > Real(1e-3)) && cosine < Real{0};
  for (int k = 0; k < 3; ++k) vector[k] = lost ? angle * fallback[k] : angle / norm * sine[k];
}

/// The axis of a half turn E = target R^T: the longest column of E + 1, normalised.
inline void half_turn_axis(const Frame<Real>& target, const Frame<Real>& frame, Real* axis) {
  Real longest = 0;
  for (int col = 0; col < 3; ++col) {
    Real column[3];
    for (int row = 0; row < 3; ++row) {
      column[row] = dot(target.rotation + 3 * row, frame.rotation + 3 * col) + (row == col ? Real{1} : Real{0});
    }
    const Real square = dot(column, column);
    if (square > longest) {
      longest = square;
      const Real scale = Real{1} / square_root(square);
      for (int k = 0; k < 3; ++k) axis[k] = scale * column[k];
    }
  }
}

inline void pose_error(const Frame<Real>& target, const Frame<Real>& frame, Task task, PoseError& error) {
  const Real* t = target.rotation;
  const Real* r = frame.rotation;
  Real* e = error.vector;
  for (int k = 0; k < 3; ++k) e[k] = target.position_m[k] - frame.position_m[k];
  for (int k = 3; k < 6; ++k) e[k] = 0;
  if (task == Task::pose || task == Task::planar) {
    // sin(angle) axis = half the sum of r_k x t_k over the columns k, cos(angle) = (sum of r_k . t_k - 1) / 2.
    Real sine[3] = {0, 0, 0};
    Real cosine = Real(-0.5);
    for (int k = 0; k < 3; ++k) {
      const Real a[3] = {r[k], r[3 + k], r[6 + k]};
      const Real b[3] = {t[k], t[3 + k], t[6 + k]};
      add_cross(a, b, Real(0.5), sine);
      cosine += Real(0.5) * dot(a, b);
    }
    if (task == Task::planar) {
      e[2] = 0;
      // The turn about z that brings the x axes together, seen in the plane.
      const Real x = r[0] * t[0] + r[3] * t[3];
      const Real y = r[0] * t[3] - r[3] * t[0];
      e[5] = x > Real(0.98) ? y : arc_tangent(y, x);
    } else {
      Real fallback[3] = {1, 0, 0};
      if (cosine < Real(-0.9)) half_turn_axis(target, frame, fallback);
      rotation_vector(sine, cosine, fallback, e + 3);
    }
  } else if (task == Task::position_axis) {
    const Real a[3] = {r[2], r[5], r[8]};
    const Real b[3] = {t[2], t[5], t[8]};
    Real sine[3] = {0, 0, 0};
    add_cross(a, b, Real{1}, sine);
    // Opposite axes: any axis across will do.
    const Real fallback[3] = {r[0], r[3], r[6]};
    rotation_vector(sine, dot(a, b), fallback, e + 3);
  }
  error.position_m = square_root(dot(e, e));
  error.rotation_rad = square_root(dot(e + 3, e + 3));
}

}  // namespace
}  // namespace mdhcal
