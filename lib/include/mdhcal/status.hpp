// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

namespace mdhcal {

/// What a function of lib/ or port/ reports. Closed: nothing outside this list is ever returned, and a value never
/// changes its number. The C header repeats the numbers.
enum class [[nodiscard]] Status : std::int32_t {
  ok = 0,             ///< Done; for an inverse: the pose is met within the tolerances, confirmed by forward().

  // Kinematics.
  step_limited = 1,   ///< Usable result; a joint's step limit stopped it short of the target.
  joint_limited = 2,  ///< Usable result; a joint limit stopped it short of the target, or holds a joint outside it.
  near_singular = 3,  ///< Usable result, short of the target: the smallest singular value of the Jacobian is below 0.01.
  out_of_reach = 4,   ///< Usable result; no joints of this arm come nearer in this neighbourhood.
  not_converged = 5,  ///< The iteration bound was reached, and none of the reasons above holds.
  bad_input = 6,      ///< An argument is NaN, infinite, out of range or not a rotation; outputs are untouched.
  bad_environment = 7, ///< The processor flushes subnormals to zero or does not round to nearest.

  // Blob.
  blob_magic = 16,      ///< Not a parameter blob.
  blob_version = 17,    ///< A format version that this library does not read.
  blob_size = 18,       ///< Truncated, or another size than the format's.
  blob_layout = 19,     ///< The layout id is not the one of the stated version.
  blob_crc = 20,        ///< The CRC-32 does not match: the bytes are damaged.
  blob_serial = 21,     ///< Made for another robot than the one the caller named.
  blob_value = 22,      ///< A value is not finite or outside its valid range.
  blob_reserved = 23,   ///< A reserved byte is not zero.
  blob_deviation = 24,  ///< The corrected geometry, a joint function or the sag is over the compiled bound.
  blob_unsigned = 25,   ///< A verifier is set and the blob carries no signature.
  blob_signature = 26,  ///< The signature does not verify.
  blob_counter = 27,    ///< The security counter is lower than the stored minimum.
  self_test_failed = 28,    ///< A self-test vector is missed: do not move with this blob.
  self_test_tolerance = 29, ///< Passed within 1e-9 m and rad (float 1e-5): the blob names another arithmetic id.

  // Flash and store.
  flash_read = 48,      ///< The driver could not read (an ECC error, for one).
  flash_program = 49,   ///< The driver could not program.
  flash_erase = 50,     ///< The driver could not erase.
  flash_verify = 51,    ///< What was read back is not what was written.
  flash_geometry = 52,  ///< The driver states a geometry that the store cannot use.
  store_empty = 53,     ///< No slot holds a blob that the loader accepts.
  store_unreadable = 54, ///< A slot that may hold a good blob cannot be read: nothing was erased or numbered anew.
};

/// The status in words: a string of static storage, never null, one line, no full stop.
const char* status_text(Status status) noexcept;

/// Whether what was asked for may be used: after a tick the joints, velocities or pose, which keep their limits though they
/// may be short of the target; after load() the arm.
constexpr bool usable(Status status) noexcept {
  return (status >= Status::ok && status <= Status::not_converged) || status == Status::self_test_tolerance;
}

}  // namespace mdhcal
