// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

/// Where every field of the parameter blob lies: format 2.0, docs/blob.md. Byte offsets from the start of the blob;
/// all numbers little-endian, reals in IEEE 754 binary64 unless the name says float. The asserts hold the contract.
namespace mdhcal::blob_layout {

/// With the slot's header 8 KiB: one sector of a flash whose sectors are small.
inline constexpr std::size_t size = 8160;
inline constexpr std::size_t granule = 32;

inline constexpr std::uint32_t magic_value = 0xCCBC6BA0U;
inline constexpr std::uint16_t major_value = 2;
inline constexpr std::uint16_t minor_value = 0;
/// CRC-32 of the canonical field list in docs/blob.md, constant within a major version.
inline constexpr std::uint32_t layout_id_value = 0x5DFD6ABFU;

/// Bits of `flags`. A reader refuses an unknown bit from `critical_flags`; other unknown bits only in its own minor.
inline constexpr std::uint32_t flag_base = 1U << 0U;        ///< tracker_T_base is stated
inline constexpr std::uint32_t flag_calibrated = 1U << 1U;  ///< made from measurements: digest and counts are stated
inline constexpr std::uint32_t flag_lambda = 1U << 2U;      ///< lambda is stated
inline constexpr std::uint32_t flag_held_out = 1U << 3U;    ///< the held-out errors are stated
inline constexpr std::uint32_t flag_region = 1U << 4U;      ///< the region that was measured is stated
inline constexpr std::uint32_t known_flags = flag_base | flag_calibrated | flag_lambda | flag_held_out | flag_region;
inline constexpr std::uint32_t critical_flags = 0xFFFF0000U;

/// Signature algorithms.
inline constexpr std::uint32_t algorithm_none = 0;
inline constexpr std::uint32_t algorithm_ed25519 = 1;

/// Bits of a joint's `flags`.
inline constexpr std::uint32_t joint_has_min = 1U << 0U;
inline constexpr std::uint32_t joint_has_max = 1U << 1U;

// Header.
inline constexpr std::size_t magic = 0;                                  // u32
inline constexpr std::size_t major = magic + 4;                          // u16
inline constexpr std::size_t minor = major + 2;                          // u16
inline constexpr std::size_t stated_size = minor + 2;                    // u32
inline constexpr std::size_t layout_id = stated_size + 4;                // u32
inline constexpr std::size_t flags = layout_id + 4;                      // u32
inline constexpr std::size_t joint_count = flags + 4;                    // u32
inline constexpr std::size_t target_count = joint_count + 4;             // u32
inline constexpr std::size_t family = target_count + 4;                  // u32
inline constexpr std::size_t security_counter = family + 4;              // u32
inline constexpr std::size_t arithmetic_id = security_counter + 4;       // u32
inline constexpr std::size_t double_vector_count = arithmetic_id + 4;    // u32
inline constexpr std::size_t float_vector_count = double_vector_count + 4;  // u32
inline constexpr std::size_t header_reserved = float_vector_count + 4;   // 16 bytes, ancillary
inline constexpr std::size_t header_reserved_size = 16;
static_assert(magic == 0 && major == 4 && minor == 6 && stated_size == 8 && layout_id == 12 && flags == 16 &&
              joint_count == 20 && target_count == 24 && family == 28 && security_counter == 32 &&
              arithmetic_id == 36 && double_vector_count == 40 && float_vector_count == 44 && header_reserved == 48);

// Identity: text, padded with zero bytes, at least one.
inline constexpr std::size_t name = header_reserved + header_reserved_size;
inline constexpr std::size_t name_size = 64;
inline constexpr std::size_t serial = name + name_size;
inline constexpr std::size_t serial_size = 32;
static_assert(name == 64 && serial == 128);

// Joints: 8 records, base to flange.
inline constexpr std::size_t joints = serial + serial_size;
inline constexpr std::size_t joint_size = 192;
inline constexpr std::size_t joint_slots = 8;
static_assert(joints == 160);
namespace joint {
inline constexpr std::size_t kind = 0;                       // u32
inline constexpr std::size_t sign = kind + 4;                // i32
inline constexpr std::size_t flags = sign + 4;               // u32
inline constexpr std::size_t reserved = flags + 4;           // 4 bytes, critical
inline constexpr std::size_t reserved_size = 4;
inline constexpr std::size_t min = reserved + reserved_size;  // f64
inline constexpr std::size_t max = min + 8;                  // f64
inline constexpr std::size_t nominal = max + 8;              // 5 f64: alpha, a, theta, d, beta
inline constexpr std::size_t corrected = nominal + 40;       // 5 f64: alpha, a, theta, d, beta
inline constexpr std::size_t coupling = corrected + 40;      // 8 f64
inline constexpr std::size_t max_velocity = coupling + 64;   // f64, 0: not stated
inline constexpr std::size_t reserved_end = max_velocity + 8;  // 8 bytes, critical
inline constexpr std::size_t reserved_end_size = 8;
static_assert(kind == 0 && sign == 4 && flags == 8 && reserved == 12 && min == 16 && max == 24 && nominal == 32 &&
              corrected == 72 && coupling == 112 && max_velocity == 176 && reserved_end == 184 &&
              reserved_end + reserved_end_size == joint_size);
}  // namespace joint

// Poses: quaternion w, x, y, z, then position, 7 f64, then 8 reserved bytes (critical).
inline constexpr std::size_t last_T_flange = joints + joint_slots * joint_size;
inline constexpr std::size_t pose_size = 64;
inline constexpr std::size_t pose_reserved = 56;
inline constexpr std::size_t tracker_T_base = last_T_flange + pose_size;
static_assert(last_T_flange == 1696 && tracker_T_base == 1760);

// Targets: 8 records of a name and 3 f64.
inline constexpr std::size_t targets = tracker_T_base + pose_size;
inline constexpr std::size_t target_size = 40;
inline constexpr std::size_t target_slots = 8;
inline constexpr std::size_t target_name_size = 16;
inline constexpr std::size_t target_point = 16;
static_assert(targets == 1824);

// Tolerances of the inverse: position and rotation, 2 f64, then the same for float, 2 f32.
inline constexpr std::size_t tolerances = targets + target_slots * target_size;
inline constexpr std::size_t float_tolerances = tolerances + 16;
inline constexpr std::size_t tolerances_reserved = float_tolerances + 8;  // 8 bytes, ancillary
inline constexpr std::size_t tolerances_reserved_size = 8;
static_assert(tolerances == 2144 && float_tolerances == 2160 && tolerances_reserved == 2168);

// Provenance.
inline constexpr std::size_t tool_version = tolerances_reserved + tolerances_reserved_size;
inline constexpr std::size_t tool_version_size = 32;
inline constexpr std::size_t date = tool_version + tool_version_size;
inline constexpr std::size_t date_size = 16;
inline constexpr std::size_t method = date + date_size;
inline constexpr std::size_t method_size = 16;
inline constexpr std::size_t measurements_sha256 = method + method_size;
inline constexpr std::size_t sha256_size = 32;
inline constexpr std::size_t lambda_rule = measurements_sha256 + sha256_size;
inline constexpr std::size_t lambda_rule_size = 32;
inline constexpr std::size_t lambda = lambda_rule + lambda_rule_size;          // f64
inline constexpr std::size_t pose_count = lambda + 8;                          // u32
inline constexpr std::size_t held_out_count = pose_count + 4;                  // u32
inline constexpr std::size_t provenance_reserved = held_out_count + 4;         // 16 bytes, ancillary
inline constexpr std::size_t provenance_reserved_size = 16;
inline constexpr std::size_t held_out = provenance_reserved + provenance_reserved_size;  // 4 f64
static_assert(tool_version == 2176 && date == 2208 && method == 2224 && measurements_sha256 == 2240 &&
              lambda_rule == 2272 && lambda == 2304 && pose_count == 2312 && held_out_count == 2316 &&
              provenance_reserved == 2320 && held_out == 2336);

// Self-test vectors: readings, pose (7), joints of the inverse, status of the inverse (i32); in double and in float.
inline constexpr std::size_t vector_slots = 4;
inline constexpr std::size_t double_vectors = held_out + 32;
inline constexpr std::size_t double_vector_size = 192;
inline constexpr std::size_t double_vector_reserved = 188;  // 4 bytes, ancillary
inline constexpr std::size_t float_vectors = double_vectors + vector_slots * double_vector_size;
inline constexpr std::size_t float_vector_size = 96;
static_assert(double_vectors == 2368 && float_vectors == 3136);
static_assert((8 + 7 + 8) * 8 + 4 == double_vector_reserved && double_vector_reserved + 4 == double_vector_size);
static_assert((8 + 7 + 8) * 4 + 4 == float_vector_size);

// Joint functions: 8 records.
inline constexpr std::size_t functions = float_vectors + vector_slots * float_vector_size;
inline constexpr std::size_t function_size = 352;
inline constexpr std::size_t function_orders = 40;
static_assert(functions == 3520);
namespace function {
inline constexpr std::size_t order_count = 0;                  // u32
inline constexpr std::size_t reserved = order_count + 4;       // 4 bytes, critical
inline constexpr std::size_t seen_min = reserved + 4;          // f64
inline constexpr std::size_t seen_max = seen_min + 8;          // f64
inline constexpr std::size_t reserved_middle = seen_max + 8;   // 8 bytes, critical
inline constexpr std::size_t cosine = reserved_middle + 8;     // 40 f32
inline constexpr std::size_t sine = cosine + 4 * function_orders;  // 40 f32
static_assert(reserved == 4 && seen_min == 8 && seen_max == 16 && reserved_middle == 24 && cosine == 32 && sine == 192 &&
              sine + 4 * function_orders == function_size);
}  // namespace function

// Gravity: direction, 3 f64; the calibration's payload, f64; its centre of mass, 3 f64.
inline constexpr std::size_t gravity = functions + joint_slots * function_size;
inline constexpr std::size_t payload = gravity + 24;
inline constexpr std::size_t payload_com = payload + 8;
inline constexpr std::size_t gravity_reserved = payload_com + 24;         // 8 bytes, critical
inline constexpr std::size_t payload_compliance = gravity_reserved + 8;   // 8 f64
inline constexpr std::size_t compliance = payload_compliance + 64;        // 8 x 8 f64, by joint
static_assert(gravity == 6336 && payload == 6360 && payload_com == 6368 && gravity_reserved == 6392 &&
              payload_compliance == 6400 && compliance == 6464);

// The region that was measured: least and largest flange position, 3 f64 each; distance from the plumb line, 2 f64.
inline constexpr std::size_t region = compliance + 512;
inline constexpr std::size_t region_size = 64;
static_assert(region == 6976);

// Room for model terms to come: critical.
inline constexpr std::size_t model_room = region + region_size;
inline constexpr std::size_t model_room_size = 992;
static_assert(model_room == 7040);

// Authentication: the signature covers every byte before this area.
inline constexpr std::size_t authentication = model_room + model_room_size;
inline constexpr std::size_t algorithm = authentication;               // u32: 0 unsigned, 1 Ed25519
inline constexpr std::size_t algorithm_reserved = algorithm + 4;       // 4 bytes, ancillary
inline constexpr std::size_t key_id = algorithm_reserved + 4;          // 8 bytes
inline constexpr std::size_t key_id_size = 8;
inline constexpr std::size_t key_reserved = key_id + key_id_size;      // 16 bytes, ancillary
inline constexpr std::size_t signature = key_reserved + 16;            // 64 bytes
inline constexpr std::size_t signature_size = 64;
inline constexpr std::size_t end_reserved = signature + signature_size;  // 28 bytes, ancillary
inline constexpr std::size_t crc = end_reserved + 28;                  // u32, of every byte before it
static_assert(authentication == 8032 && algorithm == 8032 && key_id == 8040 && key_reserved == 8048 &&
              signature == 8064 && end_reserved == 8128 && crc == 8156 && crc + 4 == size);

// Each area begins on a flash granule.
static_assert(name % granule == 0 && serial % granule == 0 && joints % granule == 0 && joint_size % granule == 0 &&
              last_T_flange % granule == 0 && targets % granule == 0 && tolerances % granule == 0 &&
              tool_version % granule == 0 && held_out % granule == 0 && double_vectors % granule == 0 &&
              float_vectors % granule == 0 && functions % granule == 0 && function_size % granule == 0 &&
              gravity % granule == 0 && payload_compliance % granule == 0 && compliance % granule == 0 &&
              region % granule == 0 && model_room % granule == 0 && authentication % granule == 0);

}  // namespace mdhcal::blob_layout
