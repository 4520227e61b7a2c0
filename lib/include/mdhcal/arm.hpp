// SPDX-License-Identifier: MIT
#pragma once

#include "mdhcal/geometry.hpp"
#include "mdhcal/status.hpp"
#include "mdhcal/transmission.hpp"

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

/// Coefficients of one sector of a joint function.
inline constexpr std::size_t sector_terms = 10;

/// Joint functions made ready: in each sector of a turn a polynomial by u, -1 at the sector's beginning and 1 at its end, that
/// meets the function at both ends. Within 2e-6 of the amplitude of order 40, 1e-9 of order 20. 20 KiB; made once for arms
/// of both precisions.
struct JointFunctionTable {
  float coefficient[max_joints][turn_sectors][sector_terms];  ///< of u^0, u^1, ... [rad]
};

/// What the transmission adds to signs and couplings, made ready. Gravity sees of a vector only what lies across it.
template <class Real>
struct ArmTerms {
  const JointFunctionTable* functions;       ///< null: none. The table has to stay as long as the arm or a copy of it
  std::uint32_t sag_mask;                    ///< bit i: joint i sags
  std::uint32_t payload_mask;                ///< bit i: joint i sags under a payload
  Real compliance[max_joints][max_joints];   ///< as in Gravity [rad/m]
  Real payload_compliance[max_joints];       ///< [rad/(kg m)]
  Real payload_kg;                           ///< the payload that the calibration was made with [kg]
  Real payload_range_kg;                     ///< how far from it a payload may be [kg]
  Real across[3][3];                         ///< two unit vectors across gravity and its direction, right-handed; base frame
  Real flange_p_m[3], payload_p_m[3];        ///< the flange's origin and the payload's centre of mass after the last link [m]
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
  std::int32_t has_terms;           ///< 0 if the transmission is signs and couplings only: the rest is not looked at then
  Real terms_share;                 ///< how much of the terms holds: 1, or 0 to 1 within a ramp, up to 0.15 beyond where it is turned back
  Real payload_kg;                  ///< the payload of now [kg]
  ArmTerms<Real> terms;
  Real inverse_map[max_joints][max_joints];  ///< inverse of `map`, where joints are coupled and have functions
  std::uint32_t seen_mask;          ///< bit i: the calibration saw readings of joint i, and not a whole turn of them
  std::uint8_t seen_first[max_joints], seen_sectors[max_joints];  ///< which, in sectors of a turn
};

/// Whether a geometry is valid: joint count, finite values within the bounds of geometry.hpp, signs, a unit flange
/// quaternion, min <= max. Returns ok or bad_input.
Status check_geometry(const Geometry& geometry) noexcept;

/// Prepares an arm. The float arm is computed in double and rounded once. Returns ok, or bad_input (arm untouched).
Status make_arm(const Geometry& geometry, Arm<double>& arm) noexcept;
Status make_arm(const Geometry& geometry, Arm<float>& arm) noexcept;

/// Makes the table of the joint functions: outside the loop, up to 4 million operations in double. Entries of joints without
/// a function are zero. `transmission` has to pass check_transmission().
void make_table(const Transmission& transmission, JointFunctionTable& table) noexcept;

/// The same with a transmission. `table` is made of its joint functions by make_table(); the arm and its copies refer to it
/// as long as they are used, if there is any function. Its payload is the calibration's. Returns as check_transmission(), and
/// bad_input where a joint has a function and the couplings cannot be inverted (arm untouched).
Status make_arm(const Geometry& geometry, const Transmission& transmission, const JointFunctionTable& table,
                Arm<double>& arm) noexcept;
Status make_arm(const Geometry& geometry, const Transmission& transmission, const JointFunctionTable& table,
                Arm<float>& arm) noexcept;

/// Puts a payload on an arm [kg]. Returns ok, or bad_input: the mass is not within 0 ... 10 000, the arm does not know what a
/// payload does and the mass is not the calibration's, or a joint's sag could pass the bound of 0.02 rad (arm untouched).
Status set_payload(Arm<double>& arm, double payload_kg) noexcept;
Status set_payload(Arm<float>& arm, float payload_kg) noexcept;

}  // namespace mdhcal
