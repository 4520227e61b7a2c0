// SPDX-License-Identifier: MIT
// Arms and random numbers for the tests of lib: plain, small, the same on every target.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>

#include "mdhcal/arm.hpp"

namespace mdhcal::test {

inline constexpr double pi = 3.14159265358979323846;
inline constexpr double deg = pi / 180.0;

/// Uniform numbers from the portable engine; std:: distributions differ between libraries.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(engine_() >> 11) * 0x1p-53);
  }
  double symmetric(double bound) { return uniform(-bound, bound); }

 private:
  std::mt19937_64 engine_;
};

/// A row of a modified DH table: alpha [deg], a [m], theta [deg], d [m].
struct Row {
  double alpha_deg, a_m, theta_deg, d_m;
};

template <std::size_t N>
Geometry from_table(const Row (&rows)[N]) {
  Geometry g{};
  g.joint_count = static_cast<std::int32_t>(N);
  for (std::size_t i = 0; i < N; ++i) {
    g.link[i].alpha_rad = rows[i].alpha_deg * deg;
    g.link[i].a_m = rows[i].a_m;
    g.link[i].theta_rad = rows[i].theta_deg * deg;
    g.link[i].d_m = rows[i].d_m;
    g.joint[i].sign = 1;
  }
  g.last_T_flange.quaternion[0] = 1;
  return g;
}

/// The robot of (Li 2022, Table 1).
inline Geometry published_robot() {
  return from_table({{0, 0, 0, 0.099927}, {90, 0, 0, 0.106950}, {0, 0.428052, 0, 0}, {0, 0.398551, 0, 0},
                     {-90, 0, 0, 0.093160}, {-90, 0, 0, 0.081910}});
}

/// A UR5: axes 2, 3, 4 parallel.
inline Geometry ur5() {
  return from_table({{0, 0, 0, 0.089159}, {90, 0, 0, 0}, {0, -0.425, 0, 0}, {0, -0.39225, 0, 0.10915},
                     {90, 0, 0, 0.09465}, {-90, 0, 0, 0.0823}});
}

/// An arm with a spherical wrist, offsets at the shoulder and the elbow, as industrial arms have.
inline Geometry wrist_arm() {
  return from_table({{0, 0, 0, 0.4}, {-90, 0.15, -90, 0}, {0, 0.6, 0, 0}, {-90, 0.12, 0, 0.64},
                     {90, 0, 0, 0}, {-90, 0, 180, 0.1}});
}

/// A PUMA 560 (Craig 2005, Fig. 3.21): a spherical wrist, no offset at the shoulder in the plane of the arm.
inline Geometry puma560() {
  return from_table({{0, 0, 0, 0}, {-90, 0, 0, 0}, {0, 0.4318, 0, 0.1244}, {-90, 0.0203, 0, 0.4318}, {90, 0, 0, 0},
                     {-90, 0, 0, 0}});
}

/// Six turning joints of no family: twists within 30 degrees of a right angle, lengths and offsets up to 0.5 m.
inline Geometry random_arm(Random& random) {
  Geometry g{};
  g.joint_count = 6;
  for (int i = 0; i < 6; ++i) {
    g.link[i].alpha_rad = (random.symmetric(1) < 0 ? -1 : 1) * random.uniform(60 * deg, 120 * deg);
    g.link[i].a_m = random.uniform(0.05, 0.5);
    g.link[i].theta_rad = random.symmetric(pi);
    g.link[i].d_m = random.symmetric(0.5);
    g.joint[i].sign = 1;
  }
  g.last_T_flange.quaternion[0] = 1;
  return g;
}

/// A seven-joint arm with spherical shoulder and wrist.
inline Geometry seven_joint_arm() {
  return from_table({{0, 0, 0, 0.36}, {-90, 0, 0, 0}, {90, 0, 0, 0.42}, {90, 0, 0, 0}, {-90, 0, 0, 0.4},
                     {-90, 0, 0, 0}, {90, 0, 0, 0.126}});
}

/// Five joints: a pointing arm.
inline Geometry five_joint_arm() {
  return from_table({{0, 0, 0, 0.15}, {-90, 0.03, 0, 0}, {0, 0.3, 0, 0}, {0, 0.25, 0, 0}, {-90, 0, 0, 0.1}});
}

/// Errors in every MD-H parameter, uniform within the bounds: a calibrated arm. Where axis i+1 is parallel to axis i
/// beta carries the tilt; elsewhere it stays zero.
inline Geometry with_errors(Geometry g, Random& random, double length_m, double angle_rad) {
  for (std::int32_t i = 0; i < g.joint_count; ++i) {
    Link& link = g.link[i];
    link.alpha_rad += random.symmetric(angle_rad);
    link.a_m += random.symmetric(length_m);
    link.theta_rad += random.symmetric(angle_rad);
    link.d_m += random.symmetric(length_m);
    const bool parallel = i + 1 < g.joint_count && std::fabs(std::sin(g.link[i + 1].alpha_rad)) < 0.02;
    if (parallel) link.beta_rad += random.symmetric(angle_rad);
  }
  return g;
}

/// Whether this runs under emulation, where tests are thinned.
#ifdef MDHCAL_EMULATED
inline constexpr bool emulated = true;
#else
inline constexpr bool emulated = false;
#endif

/// How many of `full` cases to run: all on a host, a fiftieth under emulation.
constexpr int cases(int full) {
  if (!emulated) return full;
  return full / 50 > 0 ? full / 50 : 1;
}

}  // namespace mdhcal::test
