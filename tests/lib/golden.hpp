// SPDX-License-Identifier: MIT
// A fixed sequence of operations and the hash of all that they return. Only integers and + - * / are used outside the
// library, each in one operation or exact, so that no flag of the compiler can change what goes in.
#pragma once

#include <cstdint>
#include <cstring>

#include "mdhcal/compensator.hpp"
#include "mdhcal/solutions.hpp"

namespace mdhcal::test {

/// FNV-1a over the bytes of the results, numbers all, the lowest byte first on every machine.
class Hash {
 public:
  template <class T>
  void add(const T& value) {
    unsigned char bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof(T));
    for (std::size_t i = 0; i < sizeof(T); ++i) {
      const std::size_t at = __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__ ? sizeof(T) - 1 - i : i;
      state_ = (state_ ^ bytes[at]) * 0x100000001B3ULL;
    }
  }
  std::uint64_t value() const { return state_; }

 private:
  std::uint64_t state_ = 0xCBF29CE484222325ULL;
};

/// Multiples of 2^-20 from a linear congruential generator (Knuth): exact in both precisions.
class Dyadic {
 public:
  /// In [-range, range), range a small integer.
  template <class Real>
  Real next(int range) {
    state_ = state_ * 6364136223846793005ULL + 1442695040888963407ULL;
    const std::int32_t bits = static_cast<std::int32_t>(state_ >> 43U) - (1 << 20);
    return static_cast<Real>(bits) * static_cast<Real>(0x1p-20F) * static_cast<Real>(range);
  }

 private:
  std::uint64_t state_ = 0x0123456789ABCDEFULL;
};

/// An arm whose numbers are written as exact binary fractions: parallel axes or a wrist, with errors.
inline Geometry golden_arm(bool parallel, bool errors) {
  Geometry g{};
  g.joint_count = 6;
  constexpr double right = 1.5707963267948966;
  const double alpha[2][6] = {{0, -right, 0, -right, right, -right}, {0, right, 0, 0, right, -right}};
  const double a[2][6] = {{0, 0.125, 0.625, 0.125, 0, 0}, {0, 0, -0.4375, -0.390625, 0, 0}};
  const double d[2][6] = {{0.375, 0, 0, 0.625, 0, 0.09375}, {0.09375, 0, 0, 0.109375, 0.09375, 0.078125}};
  const int row = parallel ? 1 : 0;
  for (int i = 0; i < 6; ++i) {
    const double error = errors ? 0.0009765625 * static_cast<double>(i - 2) : 0.0;
    g.link[i].alpha_rad = alpha[row][i] + error;
    g.link[i].a_m = a[row][i] + error;
    g.link[i].d_m = d[row][i] - error;
    g.link[i].theta_rad = error;
    if (parallel && (i == 1 || i == 2)) g.link[i].beta_rad = error + (errors ? 0.001953125 : 0.0);
    g.joint[i].sign = i == 3 ? -1 : 1;
    g.joint[i].has_min = g.joint[i].has_max = 1;
    g.joint[i].min = -6.25;
    g.joint[i].max = 6.25;
  }
  g.last_T_flange.quaternion[0] = 1;
  return g;
}

/// The hash of `operations` operations: in turn forward, Jacobian, tick from a near seed (also near singular ones and
/// ones out of reach), compensator in its three forms and on a ramp, joint velocities; at every 500th a cold start.
/// 0 if the library refuses the environment.
template <class Real>
std::uint64_t golden_hash(int operations) {
  Hash hash;
  Dyadic random;
  CalibratedArm<Real> models[2];
  TickOptions<Real> options[2];
  Compensator<Real> ramp[2];
  for (int m = 0; m < 2; ++m) {
    if (make_calibrated_arm(golden_arm(m == 1, false), golden_arm(m == 1, true), models[m]) != Status::ok) return 0;
    hash.add(Status::ok);
    options[m] = default_tick_options(models[m].corrected);
    for (int j = 0; j < 6; ++j) options[m].limits.max_step[j] = static_cast<Real>(0.0625F);
    hash.add(start_at_rest(models[m], Model::nominal, ramp[m]));
    hash.add(start_ramp(ramp[m], models[m], Model::corrected, 16384));
  }
  for (int n = 0; n < operations; ++n) {
    const int m = (n >> 3) & 1;
    const CalibratedArm<Real>& model = models[m];
    Real q[6];
    for (Real& joint : q) joint = random.next<Real>(3);
    if (n % 16 == 4) q[4] = q[4] * static_cast<Real>(0x1p-12F);
    Pose<Real> pose{};
    Jacobian<Real> jacobian{};
    if (n % 8 == 1) {
      hash.add(forward(model.corrected, q, pose, jacobian));
      for (int j = 0; j < 6; ++j) {
        for (const Real entry : jacobian.column[j]) hash.add(entry);
      }
    } else {
      hash.add(forward(model.corrected, q, pose));
    }
    for (const Real c : pose.quaternion) hash.add(c);
    for (const Real p : pose.position_m) hash.add(p);
    const int kind = n % 8;
    if (kind >= 2) {
      for (Real& joint : q) joint = joint + random.next<Real>(1) * static_cast<Real>(0x1p-6F);
      if (n % 64 == 10) pose.position_m[0] = static_cast<Real>(2);
      TickReport<Real> report{};
      Pose<Real> command{};
      Real velocity[6] = {};
      if (kind == 5) {
        Real nominal[6];
        for (int j = 0; j < 6; ++j) nominal[j] = q[j] + random.next<Real>(1) * static_cast<Real>(0x1p-8F);
        hash.add(joints_to_joints(ramp[m], options[m], nominal, q, &report));
      } else if (kind == 6) {
        hash.add(pose_to_pose(ramp[m], options[m], pose, q, command, &report));
        for (const Real c : command.quaternion) hash.add(c);
        for (const Real p : command.position_m) hash.add(p);
      } else if (kind == 7) {
        const Real wanted[6] = {random.next<Real>(1), random.next<Real>(1), 0, 0, random.next<Real>(1), 0};
        constexpr JointRateLimits<Real> limits{{3, 3, 3, 3, 3, 3, 3, 3}, {10, 10, 10, 10, 10, 10, 10, 10}};
        hash.add(joint_velocities(model.corrected, q, wanted, limits, velocity));
        for (const Real v : velocity) hash.add(v);
        hash.add(joint_accelerations(model.corrected, q, velocity, wanted, limits, velocity));
        for (const Real v : velocity) hash.add(v);
      } else if (n % 500 == 2) {
        hash.add(cold_start(model.corrected, default_solution_options(model.corrected), pose, q));
      } else {
        hash.add(pose_to_joints(ramp[m], options[m], pose, q, &report));
      }
      for (const Real joint : q) hash.add(joint);
      hash.add(report.position_error_m);
      hash.add(report.rotation_error_rad);
      hash.add(report.iterations);
      hash.add(advance_ramp(ramp[m]));
    }
  }
  return hash.value();
}

/// The golden numbers of 100 000 operations, and of the first 1000, which slow targets run. They change only
/// where a result does; if it is one of forward() or tick(), arithmetic_id (mdhcal/self_test.hpp) changes as well.
inline constexpr int golden_operations = 100000;
inline constexpr int golden_short = 1000;
/// Double in libgcc's software (Cortex-M4F) has the bits of the first 740 operations; in the next one a joint is two units in
/// the last place off. Its subtraction rounds to the wrong side where numbers are 2^33 apart (docs/real-time.md).
inline constexpr int golden_soft = 740;
inline constexpr std::uint64_t golden_double_soft = 0xC1782C76C0F0CA52ULL;
inline constexpr std::uint64_t golden_double = 0xA52DA3A2E07722A4ULL;
inline constexpr std::uint64_t golden_float = 0x69D1CC53D23F675CULL;
inline constexpr std::uint64_t golden_double_short = 0x46E8BCEAAC8630D2ULL;
inline constexpr std::uint64_t golden_float_short = 0x7CB77F5AD812FA85ULL;

}  // namespace mdhcal::test
