// SPDX-License-Identifier: MIT
// Private to lib/src; include after real.hpp. The chain of links, evaluated without checks.
#pragma once

#include "mdhcal/kinematics.hpp"

namespace mdhcal {

/// base_T_flange at valid readings.
void evaluate(const Arm<double>& arm, const double* q, Frame<double>& base_T_flange) noexcept;
void evaluate(const Arm<float>& arm, const float* q, Frame<float>& base_T_flange) noexcept;

/// The same with the geometric Jacobian by joint coordinate, that is before signs and couplings.
void evaluate(const Arm<double>& arm, const double* q, Frame<double>& base_T_flange,
              Jacobian<double>& coordinates) noexcept;
void evaluate(const Arm<float>& arm, const float* q, Frame<float>& base_T_flange,
              Jacobian<float>& coordinates) noexcept;

/// The Jacobian by reading, from the one by joint coordinate.
void to_readings(const Arm<double>& arm, Jacobian<double>& jacobian) noexcept;
void to_readings(const Arm<float>& arm, Jacobian<float>& jacobian) noexcept;

/// Whether make_arm() made the arm, and all readings are finite and within max_reading.
bool readings_valid(const Arm<double>& arm, const double* q) noexcept;
bool readings_valid(const Arm<float>& arm, const float* q) noexcept;

}  // namespace mdhcal
