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

/// A blob made ready for computing. Constant after load(), shared by any number of loops and threads. `corrected` and every
/// copy of it refer to `functions`: they live as long as this object does, which is copied by assignment, not byte by byte.
template <class Real>
struct CalibratedArm {
  Arm<Real> nominal;
  Arm<Real> corrected;           ///< joint kinds, signs and couplings as in `nominal`
  BlobDescription description;   ///< name, serial, targets, tolerances, provenance
  JointFunctionTable functions;  ///< of `corrected`; not written where no joint has a function

  CalibratedArm() = default;
  CalibratedArm(const CalibratedArm& other) noexcept
      : nominal(other.nominal), corrected(other.corrected), description(other.description) {
    take_functions(other);
  }
  CalibratedArm& operator=(const CalibratedArm& other) noexcept {
    if (this == &other) return *this;
    nominal = other.nominal;
    corrected = other.corrected;
    description = other.description;
    take_functions(other);
    return *this;
  }

 private:
  void take_functions(const CalibratedArm& other) noexcept {
    if (other.corrected.terms.functions == nullptr) return;
    functions = other.functions;
    corrected.terms.functions = &functions;
  }
};

/// The whole way from a blob's bytes: decode(), both arms, check_environment(), self_test(). Needs about 18 KiB of stack and
/// the time of some ticks, with joint functions of some hundred: once, outside the loop. Returns ok, or self_test_tolerance
/// (usable: the blob names another arithmetic, and the vectors are met within its tolerance); bad_input (`bytes` is null, or
/// couplings cannot be inverted where joints have functions), bad_environment, self_test_failed, or a refusal of decode():
/// then `arm` is untouched, but that a failed self-test of joint functions leaves an arm that every function refuses.
Status load(const std::uint8_t* bytes, std::size_t size, const DecodeOptions& demands, CalibratedArm<double>& arm) noexcept;
Status load(const std::uint8_t* bytes, std::size_t size, const DecodeOptions& demands, CalibratedArm<float>& arm) noexcept;

/// The same from two geometries and the transmission of the corrected one, without a blob: the description has the default tolerances (1e-10 m and rad, float 5e-6)
/// and is else empty. Returns ok, bad_input (a geometry does not pass check_geometry(), the two differ in joint count,
/// kinds, signs or couplings, or the transmission does not pass check_transmission()), blob_deviation, bad_environment; `arm` untouched unless ok.
Status make_calibrated_arm(const Geometry& nominal, const Geometry& corrected, const Transmission& transmission,
                           CalibratedArm<double>& arm) noexcept;
Status make_calibrated_arm(const Geometry& nominal, const Geometry& corrected, const Transmission& transmission,
                           CalibratedArm<float>& arm) noexcept;

/// The same without a transmission's terms.
Status make_calibrated_arm(const Geometry& nominal, const Geometry& corrected, CalibratedArm<double>& arm) noexcept;
Status make_calibrated_arm(const Geometry& nominal, const Geometry& corrected, CalibratedArm<float>& arm) noexcept;

/// The fastest that a joint moves by default_tick_options(): a turn a second, and 2 m/s if it slides. A guard against
/// jumps, above what joints of industrial arms of more than 5 kg do; who has a faster one sets max_step.
inline constexpr double default_max_velocity_rad_s = 6.283185307179586;
inline constexpr double default_max_velocity_m_s = 2.0;

/// Options for a loop of this period (0 < period_s <= 1000) [s]: the tolerances of the blob, a step limit of the blob's
/// velocities, or where it states none of the default ones, times the period, else as default_tick_options(arm). With another period the step limits are 0, which
/// tick() refuses.
TickOptions<double> default_tick_options(const CalibratedArm<double>& arm, double period_s) noexcept;
TickOptions<float> default_tick_options(const CalibratedArm<float>& arm, float period_s) noexcept;

/// The calibrated target point of this name (zero-terminated), or null.
const Target* find_target(const BlobDescription& description, const char* name) noexcept;

}  // namespace mdhcal
