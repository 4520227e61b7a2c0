// SPDX-License-Identifier: MIT
#pragma once

#include "mdhcal/geometry.hpp"
#include "mdhcal/status.hpp"

namespace mdhcal {

/// One link of a prepared arm: the geometry's constants with the sines and cosines of the fixed angles taken.
template <class Real>
struct ArmLink {
  Real sin_alpha, cos_alpha;  ///< [1]
  Real sin_beta, cos_beta;    ///< [1]
  Real a_m, d_m;              ///< [m]
  Real theta_rad;             ///< [rad]
  Real sign;                  ///< of the joint's own reading, +1 or -1: Arm::map[i][i]
};

/// A rigid transform as a rotation matrix, row-major, and a translation [m].
template <class Real>
struct Frame {
  Real rotation[9];
  Real position_m[3];
};

/// What make_arm() marks an arm with: storage that was not filled in, or of another precision, holds another number, save
/// with a chance of 2^-32.
template <class Real>
inline constexpr std::uint32_t arm_mark = sizeof(Real) == sizeof(double) ? 0x6D1F83A5U : 0x2B9C40E7U;

/// An arm prepared for the servo loop: constant after make_arm(), shared by any number of loops. Plain data.
template <class Real>
struct Arm {
  std::uint32_t mark;               ///< arm_mark; every function refuses another with bad_input
  std::int32_t joint_count;         ///< 1 ... max_joints
  std::int32_t coupled;             ///< 1 if a joint coordinate depends on another joint's reading
  std::uint32_t prismatic_mask;     ///< bit i: joint i slides
  std::uint32_t min_mask, max_mask; ///< bit i: the limit holds
  ArmLink<Real> link[max_joints];
  Real map[max_joints][max_joints]; ///< joint coordinate i = sum_j map[i][j] reading j
  Real min[max_joints], max[max_joints];  ///< limits of the readings [rad] or [m]
  std::int32_t has_flange;          ///< 0 if last_T_flange is the identity: it is not looked at then. 1 always works
  Frame<Real> last_T_flange;
  Real reach_m;                     ///< upper bound of the flange's distance from the base, for scaling [m]
};

/// Whether a geometry is valid: joint count, finite values within the bounds of geometry.hpp, signs, a unit flange
/// quaternion, min <= max. Returns ok or bad_input.
Status check_geometry(const Geometry& geometry) noexcept;

/// Prepares an arm. The float arm is computed in double and rounded once. Returns ok, or bad_input (arm untouched).
Status make_arm(const Geometry& geometry, Arm<double>& arm) noexcept;
Status make_arm(const Geometry& geometry, Arm<float>& arm) noexcept;

}  // namespace mdhcal
