// SPDX-License-Identifier: MIT
#pragma once

#include "mdhcal/geometry.hpp"
#include "mdhcal/status.hpp"

namespace mdhcal {

/// The highest order of a joint function.
inline constexpr std::size_t max_orders = 40;
/// A turn is divided into this many sectors: the corners of a joint function's window lie on their ends.
inline constexpr std::int32_t turn_sectors = 64;
/// The window falls to zero over this many sectors (0.39 rad), or over half of the readings not seen if these are fewer.
inline constexpr std::int32_t fade_sectors = 4;

/// A joint's periodic error, added to its coordinate [rad]; r: the joint's own reading [rad], whatever its sign and couplings:
///   f(r) = w(r) sum over k = 1 ... order_count of  cosine_rad[k-1] cos(k r) + sine_rad[k-1] sin(k r).
/// The window w is 1 at the readings seen, counted modulo a turn and rounded inwards to ends of sectors, and falls to 0 on
/// both sides as 1 - 3 s^2 + 2 s^3 does. Less than four sectors short of a turn, it is 1 everywhere. f has period 2 pi.
/// Coefficients are float: eight joints of double would not fit the blob, and the rounding is below 1e-9 rad.
struct JointFunction {
  double seen_min_rad, seen_max_rad;  ///< the readings that the calibration saw, min < max; both 0: not stated
  std::int32_t order_count;           ///< 0 (no function) ... max_orders; entries from here on are zero
  std::int32_t reserved;              ///< 0
  float cosine_rad[max_orders];       ///< of orders 1, 2, ... [rad]
  float sine_rad[max_orders];         ///< likewise [rad]
};

/// How joints turn under gravity. Points: o_i, the origin of base_T_i = A_1 ... A_i, and o_{N+1}, the flange's. With g =
/// direction and z_i the axis of joint i, all of the corrected geometry at the joint coordinates before sag:
///   sag_i = sum over j = i ... N of  compliance[i][j] z_i . ((o_{j+1} - o_i) x g)
///         + (payload - payload_kg) payload_compliance[i] z_i . ((p - o_i) x g),
/// where p is the payload's centre of mass and `payload` its mass at run time [kg]. Indices here from 1, in arrays from 0.
struct Gravity {
  double direction[3];                         ///< where things fall, in the base frame, of length 1; all zero: no sag
  double compliance[max_joints][max_joints];   ///< [joint][link]: compliance times weight of the link's end [rad/m];
                                               ///< zero for link < joint and for joints that slide
  double payload_compliance[max_joints];       ///< the same of one kilogram of payload [rad/(kg m)]; all zero: not known
  double payload_kg;                           ///< the payload that the calibration was made with [kg], 0 ... 10 000
  double payload_com_m[3];                     ///< its centre of mass in the flange frame [m]
};

/// The map from readings to joint coordinates beyond signs and couplings (Geometry::joint):
///   coordinate_i = sum_j map_ij reading_j + f_i(reading_i) + sag_i.
/// Geometry follows it unchanged. All zero: none of it. Plain data; check_transmission() says whether it is valid.
struct Transmission {
  JointFunction function[max_joints];
  Gravity gravity;
};

/// Bounds of what a decoder accepts, unless the library was compiled with others (MDHCAL_MAX_JOINT_FUNCTION_RAD,
/// MDHCAL_MAX_JOINT_FUNCTION_SLOPE, MDHCAL_MAX_SAG_RAD). They make the map from readings to coordinates one to one (docs/blob.md).
inline constexpr double default_max_joint_function_rad = 0.005;  ///< of the sum over orders of the amplitudes [rad]
inline constexpr double default_max_joint_function_slope = 0.1;  ///< of the sum over orders of order times amplitude [1]
inline constexpr double default_max_sag_rad = 0.02;              ///< of a joint's sag in any posture, payload included [rad]

/// The bound of the sag that this library was compiled with [rad].
double max_sag_rad() noexcept;

/// Whether a transmission is valid for a geometry that check_geometry() accepts. Returns ok; bad_input (a number that is not
/// finite or out of its range; a function or compliance of a joint that slides; something beyond joint_count or order_count;
/// a direction whose length is neither 1 nor 0; compliance without a direction); blob_deviation (a bound above is passed:
/// the sag's is sum over j of |compliance_ij| times the length of the chain from joint i to link j's end).
Status check_transmission(const Geometry& geometry, const Transmission& transmission) noexcept;

/// f(reading) [rad] and its derivative by the reading [1], from the series, in double: what the arm's table is made from. For
/// the host and for tests; the servo loop interpolates. |reading| <= max_reading; a valid function.
void evaluate_joint_function(const JointFunction& function, double reading_rad, double& value_rad, double& slope) noexcept;

}  // namespace mdhcal
