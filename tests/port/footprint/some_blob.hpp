// SPDX-License-Identifier: MIT
// Blobs of many arms, made on the target out of a golden one.
#pragma once

#include <cstring>

#include "golden_blobs.hpp"
#include "inputs.hpp"
#include "mdhcal/blob_layout.hpp"
#include "mdhcal/crc32.hpp"
#include "mdhcal/inverse.hpp"
#include "mdhcal/kinematics.hpp"
#include "mdhcal/self_test.hpp"

namespace footprint {

template <class Real>
void write_vector(const mdhcal::Geometry& geometry, const double (&q_rad)[6], std::uint8_t* to) {
  using namespace mdhcal;
  Arm<Real> arm;
  Status status = make_arm(geometry, arm);
  Real values[2 * max_joints + 7] = {};
  Real* inverse_q = values + max_joints + 7;
  for (int k = 0; k < 6; ++k) {
    values[k] = static_cast<Real>(q_rad[k]);
    inverse_q[k] = values[k] + static_cast<Real>(k % 2 == 0 ? self_test_offset : -self_test_offset);
  }
  Pose<Real> pose;
  status = forward(arm, values, pose);
  std::memcpy(values + max_joints, pose.quaternion, sizeof pose.quaternion);
  std::memcpy(values + max_joints + 4, pose.position_m, sizeof pose.position_m);
  status = tick(arm, default_tick_options(arm), pose, inverse_q);
  const std::int32_t number = static_cast<std::int32_t>(status);
  std::memcpy(to, values, sizeof values);
  std::memcpy(to + sizeof values, &number, sizeof number);
}

/// A blob of a calibrated arm of its own. Its self-test vectors, two a precision, are the arm's or some other's.
inline void some_blob(std::uint64_t seed, bool with_vectors, std::uint8_t (&blob)[mdhcal::blob_layout::size]) {
  using namespace mdhcal;
  std::memcpy(blob, golden::six_joints, sizeof blob);
  const Geometry nominal = nominal_arm();
  const Geometry corrected = calibrated_arm(seed);
  for (std::size_t i = 0; i < 6; ++i) {
    std::uint8_t* at = blob + blob_layout::joints + i * blob_layout::joint_size;
    const std::int32_t sign = 1;
    std::memcpy(at + blob_layout::joint::sign, &sign, sizeof sign);
    std::memset(at + blob_layout::joint::coupling, 0, 8 * max_joints);
    const auto put = [](const Link& link, std::uint8_t* to) {
      const double values[5] = {link.alpha_rad, link.a_m, link.theta_rad, link.d_m, link.beta_rad};
      std::memcpy(to, values, sizeof values);
    };
    put(nominal.link[i], at + blob_layout::joint::nominal);
    put(corrected.link[i], at + blob_layout::joint::corrected);
  }
  // Without the golden one's terms: its vectors are of the geometry.
  std::memset(blob + blob_layout::functions, 0, blob_layout::region - blob_layout::functions);
  Random random(seed);
  for (std::size_t i = 0; with_vectors && i < 2; ++i) {
    double q_rad[6];
    joints(Set::mixed, static_cast<int>(i), random, q_rad);
    write_vector<double>(corrected, q_rad, blob + blob_layout::double_vectors + i * blob_layout::double_vector_size);
    write_vector<float>(corrected, q_rad, blob + blob_layout::float_vectors + i * blob_layout::float_vector_size);
  }
  const std::uint32_t crc = crc32(blob, blob_layout::crc);
  std::memcpy(blob + blob_layout::crc, &crc, sizeof crc);
}

}  // namespace footprint
