// SPDX-License-Identifier: MIT
// What the fuzzers feed. Each takes any bytes and returns; it aborts, with a line on stderr, if something that
// docs/security.md promises does not hold. Under the sanitizers the rest is theirs to see.
#pragma once

#include <cstddef>
#include <cstdint>

namespace mdhcal::fuzz {

/// decode(): the bytes as they are, and cut or padded to a blob with its CRC repaired in half of the inputs.
void blob_target(const std::uint8_t* data, std::size_t size);

/// The loader of the C header in both precisions, with the bytes likewise: it refuses what decode() refuses, with the same
/// status and the model untouched, and what it loads gives finite poses.
void loader_target(const std::uint8_t* data, std::size_t size);

/// parse_robot(), then write_robot() and back, then make_blob().
void robot_target(const std::uint8_t* data, std::size_t size);

/// parse_dataset() for a six-joint robot.
void dataset_target(const std::uint8_t* data, std::size_t size);

/// parse_urdf() and what is made of it: a robot, which is valid; its own URDF, which reads back; the same URDF corrected, which reads
/// back too.
void urdf_target(const std::uint8_t* data, std::size_t size);

/// parse_ros_kinematics() and the robot of it, which is valid.
void kinematics_target(const std::uint8_t* data, std::size_t size);

/// parse_ur_calibration() and the robot of it, which is valid.
void ur_calibration_target(const std::uint8_t* data, std::size_t size);

/// read_joint_file(), which also reads the candidates of a plan, for a six-joint robot: every reading is finite.
void joints_target(const std::uint8_t* data, std::size_t size);

/// read_pose_file(), for a six-joint robot: every pose is finite and a unit rotation.
void poses_target(const std::uint8_t* data, std::size_t size);

/// read_manifest(): every entry's name is a folder's own, and each is there once.
void manifest_target(const std::uint8_t* data, std::size_t size);

/// read_secret_key() and read_public_key(): both take the same, and what is written of a key reads back.
void key_target(const std::uint8_t* data, std::size_t size);

/// read_source() of a tracker's export or a controller's log for a six-joint robot, then join() with itself.
void source_target(const std::uint8_t* data, std::size_t size);

/// read_program() in every language: each number's bytes are the number.
void program_target(const std::uint8_t* data, std::size_t size);

/// filter_program() in every language, for a six-joint arm: what it gives is the text with numbers and flags replaced.
void filter_target(const std::uint8_t* data, std::size_t size);

/// parse_profile(), then a table read by it.
void profile_target(const std::uint8_t* data, std::size_t size);

}  // namespace mdhcal::fuzz
