// SPDX-License-Identifier: MIT
// Private to lib/src. How long the levers may be that weights have about the joints.
#pragma once

#include "mdhcal/geometry.hpp"
#include "number/compare.hpp"

namespace mdhcal {
namespace {

// The most that a reading may be.
inline double furthest_reading(const Joint& joint) {
  if (joint.has_min == 0 || joint.has_max == 0) return max_reading;
  const double low = magnitude(joint.min);
  const double high = magnitude(joint.max);
  return low > high ? low : high;
}

// The longest way from the joint's axis before link `i` to the origin after it.
inline double longest_link(const Geometry& geometry, std::int32_t i) {
  double length = magnitude(geometry.link[i].a_m) + magnitude(geometry.link[i].d_m);
  if (geometry.joint[i].kind == JointKind::prismatic) {
    length += furthest_reading(geometry.joint[i]);
    for (std::int32_t j = 0; j < geometry.joint_count; ++j) {
      length += magnitude(geometry.joint[i].coupling[j]) * furthest_reading(geometry.joint[j]);
    }
  }
  return length;
}

/// The longest way from the axis of joint i to the end of link j >= i, which is the flange's origin for the last.
inline double longest_lever(const Geometry& geometry, std::int32_t i, std::int32_t j) {
  double length = 0.0;
  for (std::int32_t k = i + 1; k <= j && k < geometry.joint_count; ++k) length += longest_link(geometry, k);
  if (j + 1 < geometry.joint_count) return length + longest_link(geometry, j + 1);
  for (const double p : geometry.last_T_flange.position_m) length += magnitude(p);
  return length;
}

}  // namespace
}  // namespace mdhcal
