// SPDX-License-Identifier: MIT
// The arm and the joint vectors over which the costs are measured.
#pragma once

#include <cstdint>

#include "mdhcal/transmission.hpp"

namespace footprint {

inline constexpr int input_count = 1000;

/// Portable random numbers (xorshift64*, Vigna 2016).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  double uniform(double low, double high) {
    state_ ^= state_ >> 12;
    state_ ^= state_ << 25;
    state_ ^= state_ >> 27;
    const std::uint64_t bits = (state_ * 2685821657736338717U) >> 11;
    return low + (high - low) * (static_cast<double>(bits) * 0x1p-53);
  }

 private:
  std::uint64_t state_;
};

/// A six-joint arm with three parallel axes (li2022, Table 1).
inline mdhcal::Geometry nominal_arm() {
  constexpr double deg = 3.14159265358979323846 / 180.0;
  constexpr double table[6][3] = {{0, 0, 99.927},   {90, 0, 106.950}, {0, 428.052, 0},
                                  {0, 398.551, 0}, {-90, 0, 93.160}, {-90, 0, 81.910}};
  mdhcal::Geometry geometry{};
  geometry.joint_count = 6;
  for (int i = 0; i < 6; ++i) {
    geometry.link[i].alpha_rad = table[i][0] * deg;
    geometry.link[i].a_m = table[i][1] * 1e-3;
    geometry.link[i].d_m = table[i][2] * 1e-3;
    geometry.joint[i].sign = 1;
  }
  geometry.last_T_flange.quaternion[0] = 1;
  return geometry;
}

/// The same with errors of up to 1 mm and 0.1 degrees in every parameter.
inline mdhcal::Geometry calibrated_arm(std::uint64_t seed = 20220822) {
  constexpr double tenth_deg = 3.14159265358979323846 / 1800.0;
  Random random(seed);
  mdhcal::Geometry geometry = nominal_arm();
  for (int i = 0; i < 6; ++i) {
    mdhcal::Link& link = geometry.link[i];
    link.alpha_rad += random.uniform(-tenth_deg, tenth_deg);
    link.a_m += random.uniform(-1e-3, 1e-3);
    link.d_m += random.uniform(-1e-3, 1e-3);
    link.theta_rad = random.uniform(-tenth_deg, tenth_deg);
    link.beta_rad = i == 1 || i == 2 ? random.uniform(-tenth_deg, tenth_deg) : 0.0;
  }
  return geometry;
}

/// Every term in use on the six joints: forty orders of up to 0.3 mrad in five of them and 0.02 mrad in the others, seen all
/// round but on one joint; every link's weight on every joint before it, some 2 mrad together; a payload.
inline void every_term(mdhcal::Transmission& transmission) {
  transmission = {};
  Random random(40);
  mdhcal::Gravity& gravity = transmission.gravity;
  gravity.direction[2] = -1;
  for (int i = 0; i < 6; ++i) {
    mdhcal::JointFunction& f = transmission.function[i];
    f.order_count = 40;
    f.seen_min_rad = -3.1;
    f.seen_max_rad = i == 3 ? 2.0 : 3.1;
    for (int k = 0; k < 40; ++k) {
      const double bound = k < 2 || k == 9 || k == 17 || k == 27 ? 3e-4 : 2e-5;
      f.cosine_rad[k] = static_cast<float>(random.uniform(-bound, bound));
      f.sine_rad[k] = static_cast<float>(random.uniform(-bound, bound));
    }
    for (int j = i; j < 6; ++j) gravity.compliance[i][j] = random.uniform(0, 1e-3);
    gravity.payload_compliance[i] = 2e-4;
  }
  gravity.payload_com_m[2] = 0.1;
}

/// Joints at least 0.3 rad from the wrist's and the elbow's singularity, within 0.01 rad of one or both, or by turns.
enum class Set { regular, near_singular, mixed };

inline const char* name_of(Set set) {
  return set == Set::regular ? "regular" : set == Set::near_singular ? "near-singular" : "mixed";
}

/// Those of input number `i`.
inline void joints(Set set, int i, Random& random, double (&q_rad)[6]) {
  for (double& q : q_rad) q = random.uniform(-3.1, 3.1);
  const double side_elbow = q_rad[2] < 0 ? -1 : 1;
  const double side_wrist = q_rad[4] < 0 ? -1 : 1;
  q_rad[2] = side_elbow * random.uniform(0.3, 2.8);
  q_rad[4] = side_wrist * random.uniform(0.3, 2.8);
  if (set == Set::near_singular || (set == Set::mixed && i % 2 != 0)) {
    const double which = random.uniform(0, 3);
    if (which < 2) q_rad[4] = random.uniform(-0.01, 0.01);
    if (which > 1) q_rad[2] = random.uniform(-0.01, 0.01);
  }
}

}  // namespace footprint
