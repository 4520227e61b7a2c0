// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

#include "mdhcal/blob_layout.hpp"
#include "mdhcal/geometry.hpp"
#include "mdhcal/status.hpp"
#include "mdhcal/transmission.hpp"

namespace mdhcal {

/// The size of every parameter blob [bytes].
inline constexpr std::size_t blob_size = blob_layout::size;
/// The most named target points.
inline constexpr std::size_t max_targets = blob_layout::target_slots;
/// How far a corrected parameter may be from its nominal, unless the library was compiled with other bounds
/// (MDHCAL_MAX_DEVIATION_M, MDHCAL_MAX_DEVIATION_RAD).
inline constexpr double default_max_deviation_m = 0.05;
inline constexpr double default_max_deviation_rad = 0.05;
/// The bounds that this library was compiled with [m], [rad].
double max_deviation_m() noexcept;
double max_deviation_rad() noexcept;
/// The most self-test vectors of one precision.
inline constexpr std::size_t max_vectors = blob_layout::vector_slots;

/// A named target point.
struct Target {
  char name[blob_layout::target_name_size];  ///< UTF-8, ends with a zero byte
  double flange_p_m[3];                      ///< in the flange frame [m]
};

/// When an inverse is done, in double and in float. Each in (0, 1].
struct Tolerances {
  double position_m, rotation_rad;             ///< [m], [rad]
  float float_position_m, float_rotation_rad;  ///< [m], [rad]
};

/// Where a calibration comes from. What is absent is zero; dates and figures are for people, nothing depends on them.
struct BlobProvenance {
  char tool_version[blob_layout::tool_version_size];  ///< of the program that wrote the blob
  char date[blob_layout::date_size];                  ///< YYYY-MM-DD
  char method[blob_layout::method_size];              ///< of identification, as --method names it; empty without one
  char lambda_rule[blob_layout::lambda_rule_size];    ///< as --lambda-rule names it; empty without one
  std::uint8_t measurements_sha256[blob_layout::sha256_size];  ///< of the measurement file's bytes
  std::uint32_t pose_count;      ///< poses that the identification used
  std::uint32_t held_out_count;  ///< poses that judged it
  std::int32_t has_measurements; ///< 1 if the blob was identified from measurements: digest and pose_count hold
  std::int32_t has_lambda;       ///< 1 if `lambda` holds
  std::int32_t has_held_out;     ///< 1 if the four figures and held_out_count hold
  double lambda;                 ///< regularization parameter [mm^2], or [1] where the residuals have a sigma
  double mean_before_m, max_before_m;  ///< held-out position error with the nominal geometry [m]
  double mean_after_m, max_after_m;    ///< held-out position error with the corrected geometry [m]
  std::int32_t has_region;             ///< 1 if the region holds: outside it nobody has seen what the calibration is worth
  double region_min_m[3], region_max_m[3];  ///< of the flange's positions that were measured, in the base frame [m]
  double lean_min_m, lean_max_m;       ///< of their distances from the plumb line through the base's origin [m]
};

/// One self-test vector: what the host computed.
template <class Real>
struct SelfTestVector {
  Real q[max_joints];            ///< readings [rad] or [m]
  Pose<Real> base_T_flange;      ///< forward(q)
  Real inverse_q[max_joints];    ///< where the inverse came to from the perturbed seed [rad] or [m]
  std::int32_t inverse_status;   ///< what the inverse reported
};

/// The signature as the blob carries it; decode() has verified it if it was given a verifier.
struct Authentication {
  std::uint32_t algorithm;                           ///< 0 unsigned, 1 Ed25519
  std::uint8_t key_id[blob_layout::key_id_size];     ///< first bytes of the public key: a hint, not signed
  std::uint8_t signature[blob_layout::signature_size];
};

/// What a blob says beside the geometry. Plain data.
struct BlobDescription {
  char name[blob_layout::name_size];      ///< robot, UTF-8, ends with a zero byte
  char serial[blob_layout::serial_size];  ///< likewise; empty if none
  std::int32_t has_base;         ///< 1 if tracker_T_base holds
  std::int32_t target_count;     ///< 0 ... max_targets
  Pose<double> tracker_T_base;   ///< base frame in the frame of the measurements; identity without one
  Target target[max_targets];
  ArmFamily family;
  std::uint32_t security_counter; ///< a loader refuses a blob below its stored minimum
  Tolerances tolerances;
  double max_velocity[max_joints];  ///< the fastest that each joint may be asked to move [rad/s] or [m/s]; 0: not stated
  BlobProvenance provenance;
};

/// The decoded content of a blob. Plain data.
struct BlobContent : BlobDescription {
  Geometry geometry;             ///< corrected: what the arm is
  Link nominal[max_joints];      ///< what its drawing says; joints and flange as in `geometry`
  Transmission transmission;     ///< of the corrected arm, beyond signs and couplings; all zero: none
  std::uint32_t arithmetic_id;   ///< of the library that computed the vectors
  std::int32_t double_vector_count, float_vector_count;  ///< 0 ... max_vectors
  SelfTestVector<double> double_vector[max_vectors];
  SelfTestVector<float> float_vector[max_vectors];
  Authentication authentication;
};

/// A check of a signature, brought by the port. `verify` returns true if `signature` [64] is the one of `size` bytes at
/// `message`; `context` is passed through. It may be called once a decode.
struct Verifier {
  bool (*verify)(const std::uint8_t* message, std::size_t size, const std::uint8_t* signature, void* context);
  void* context;
};

/// What a caller demands of a blob beyond its being one.
struct DecodeOptions {
  const char* serial = nullptr;           ///< the robot's serial, zero-terminated; null: any
  Verifier verifier = {nullptr, nullptr}; ///< null: signatures are not looked at
  std::uint32_t minimum_counter = 0;      ///< the least security counter that is accepted
};

/// Decodes a blob (docs/blob.md). Total: any bytes, any alignment, no partial result - the model is written whole, after
/// every check, or not touched. Returns ok, or in this order of checks blob_size, blob_magic, blob_version, blob_size
/// (stated), blob_layout, blob_crc, blob_unsigned, blob_signature, blob_counter, blob_reserved, blob_value,
/// blob_deviation (a length of the corrected geometry over max_deviation_m() from its nominal, or an angle over
/// max_deviation_rad(), or a term of the transmission over its
/// bound, mdhcal/transmission.hpp), blob_serial. An ok model's geometry passes check_geometry(), its transmission
/// check_transmission().
Status decode(const std::uint8_t* bytes, std::size_t size, const DecodeOptions& options, BlobContent& model) noexcept;

}  // namespace mdhcal
