// SPDX-License-Identifier: MIT
#pragma once

#include "mdhcal/blob.hpp"
#include "mdhcal/inverse.hpp"

namespace mdhcal {

/// Which of the two geometries of a calibrated arm.
enum class Model : std::int32_t {
  nominal = 0,    ///< the one that the controller believes
  corrected = 1,  ///< the one that the arm was found to have
};

/// A blob made ready for computing. Constant after load(), shared by any number of loops and threads. Plain data.
template <class Real>
struct CalibratedArm {
  Arm<Real> nominal;
  Arm<Real> corrected;          ///< joint kinds, signs and couplings as in `nominal`
  BlobDescription description;  ///< name, serial, targets, tolerances, provenance
};

/// The whole way from a blob's bytes: decode(), both arms, check_environment(), self_test(). Needs about 8 KiB of stack and
/// the time of some ticks: once, outside the loop. Returns ok, or self_test_tolerance (usable: the blob names another
/// arithmetic, and the vectors are met within its tolerance); bad_input (`bytes` is null), bad_environment,
/// self_test_failed, or a refusal of decode(): then `arm` is untouched.
Status load(const std::uint8_t* bytes, std::size_t size, const DecodeOptions& demands, CalibratedArm<double>& arm) noexcept;
Status load(const std::uint8_t* bytes, std::size_t size, const DecodeOptions& demands, CalibratedArm<float>& arm) noexcept;

/// The same from two geometries, without a blob: the description has the default tolerances (1e-10 m and rad, float 5e-6)
/// and is else empty. Returns ok, bad_input (a geometry does not pass check_geometry(), or the two differ in joint count,
/// kinds, signs or couplings), bad_environment; `arm` untouched unless ok.
Status make_calibrated_arm(const Geometry& nominal, const Geometry& corrected, CalibratedArm<double>& arm) noexcept;
Status make_calibrated_arm(const Geometry& nominal, const Geometry& corrected, CalibratedArm<float>& arm) noexcept;

/// The fastest that a joint moves by default_tick_options(): a turn a second, and 2 m/s if it slides. A guard against
/// jumps, above what joints of industrial arms of more than 5 kg do; who has a faster one sets max_step.
inline constexpr double default_max_velocity_rad_s = 6.283185307179586;
inline constexpr double default_max_velocity_m_s = 2.0;

/// Options for a loop of this period (0 < period_s <= 1000) [s]: the tolerances of the blob, a step limit of the default
/// velocities times the period, else as default_tick_options(arm). With another period the step limits are 0, which
/// tick() refuses.
TickOptions<double> default_tick_options(const CalibratedArm<double>& arm, double period_s) noexcept;
TickOptions<float> default_tick_options(const CalibratedArm<float>& arm, float period_s) noexcept;

/// The calibrated target point of this name (zero-terminated), or null.
const Target* find_target(const BlobDescription& description, const char* name) noexcept;

}  // namespace mdhcal
