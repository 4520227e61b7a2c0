// SPDX-License-Identifier: MIT
// Private to lib/src; include after real.hpp. The chain of links, evaluated without checks.
#pragma once

#include "mdhcal/kinematics.hpp"

namespace mdhcal {

/// Where evaluate() leaves the second derivatives of the joint functions by their readings [1/rad] on an arm with terms and no
/// more than six joints: in the first column of the Jacobian that these leave free.
constexpr std::int32_t curvature_column = 6;

/// base_T_flange at valid readings.
void evaluate(const Arm<double>& arm, const double* q, Frame<double>& base_T_flange) noexcept;
void evaluate(const Arm<float>& arm, const float* q, Frame<float>& base_T_flange) noexcept;

/// The same with the geometric Jacobian by joint coordinate: after signs and couplings, before the transmission's terms, whose
/// slopes it holds. So Arm::map makes of it the one by reading, with terms or without.
void evaluate(const Arm<double>& arm, const double* q, Frame<double>& base_T_flange,
              Jacobian<double>& coordinates) noexcept;
void evaluate(const Arm<float>& arm, const float* q, Frame<float>& base_T_flange,
              Jacobian<float>& coordinates) noexcept;

/// The same as if the arm had no terms: its geometry.
void evaluate_plain(const Arm<double>& arm, const double* q, Frame<double>& base_T_flange,
                    Jacobian<double>& coordinates) noexcept;
void evaluate_plain(const Arm<float>& arm, const float* q, Frame<float>& base_T_flange, Jacobian<float>& coordinates) noexcept;

/// What the terms add to each joint's coordinate [rad].
void coordinates_by_terms(const Arm<double>& arm, const double* q, double* added) noexcept;
void coordinates_by_terms(const Arm<float>& arm, const float* q, float* added) noexcept;

/// The Jacobian by reading, from the one by joint coordinate.
void to_readings(const Arm<double>& arm, Jacobian<double>& jacobian) noexcept;
void to_readings(const Arm<float>& arm, Jacobian<float>& jacobian) noexcept;

/// Bit i: the calibration states which readings of joint i it saw, and q[i] is not one of them, counted modulo a turn.
std::uint32_t unseen_readings(const Arm<double>& arm, const double* q) noexcept;
std::uint32_t unseen_readings(const Arm<float>& arm, const float* q) noexcept;

/// Whether make_arm() made the arm, and all readings are finite and within max_reading.
bool readings_valid(const Arm<double>& arm, const double* q) noexcept;
bool readings_valid(const Arm<float>& arm, const float* q) noexcept;

}  // namespace mdhcal
