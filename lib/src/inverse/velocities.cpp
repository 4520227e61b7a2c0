// SPDX-License-Identifier: MIT
#include "mdhcal/velocities.hpp"

#include "number/real.hpp"

#include "arm/chain.hpp"
#include "arm/rotation.hpp"
#include "inverse/svd.hpp"
#include "number/compare.hpp"

namespace mdhcal {

namespace {

bool all_within(const Real* x, int count, Real low, Real high) {
  for (int k = 0; k < count; ++k) {
    if (!within(low, x[k], high)) return false;
  }
  return true;
}

// The square of the damping of singular value s. The derivative of s / (s^2 + k^2) is at most of the order of 1 / motion^2
// below s = motion and 1 / s^2 above it, where k is 0; there is no corner between.
Real damping_square(Real s, Real motion_square) {
  if (!(s * s < motion_square)) return Real{0};
  const Real share = Real{1} - s * s / motion_square;
  return motion_square * share * share;
}

bool valid(const JointRateLimits<Real>& limits, std::int32_t joints) {
  return all_within(limits.max_velocity, joints, Real(1e-6), Real(1e6)) &&
         all_within(limits.max_acceleration, joints, Real(1e-6), Real(1e6));
}

// What an inverse of the Jacobian is made of: lengths over the arm's, readings unit-free.
struct Resolution {
  SingularBasis basis;
  Real length_m;
  Real unit[max_joints];
  std::int32_t joints, rank;
};

void even_out(const Resolution& r, const Real* motion, Real* even) {
  for (int k = 0; k < 6; ++k) even[k] = k < 3 ? motion[k] / r.length_m : motion[k];
}

void prepare(const Arm<Real>& arm, const Jacobian<Real>& jacobian, Resolution& r) {
  r.joints = arm.joint_count;
  r.rank = r.joints < 6 ? r.joints : 6;
  r.length_m = arm.reach_m > Real(1e-6) ? arm.reach_m : Real{1};
  for (std::int32_t j = 0; j < r.joints; ++j) {
    r.unit[j] = ((arm.prismatic_mask >> static_cast<std::uint32_t>(j)) & 1U) != 0U ? r.length_m : Real{1};
    for (int k = 0; k < 6; ++k) r.basis.us[j][k] = jacobian.column[j][k] * r.unit[j] / (k < 3 ? r.length_m : Real{1});
  }
  decompose(r.basis, r.joints);
}

// x with J x = wanted as far as the damping for the flange's `motion` and `bound` allow; J by reading.
Status resolve(const Resolution& r, const Jacobian<Real>& jacobian, const Real* wanted, const Real* motion,
               const Real* max_acceleration, const Real* bound, Real* x) {
  const std::int32_t joints = r.joints;
  Real even[6], moving[6];
  even_out(r, wanted, even);
  even_out(r, motion, moving);
  Real least_acceleration = max_acceleration[0] / r.unit[0];
  for (std::int32_t j = 1; j < joints; ++j) {
    const Real own = max_acceleration[j] / r.unit[j];
    if (own < least_acceleration) least_acceleration = own;
  }
  // The Jacobian changes no faster than the arm moves: joints that follow within motion^2 = speed^2 / acceleration of a
  // singularity would be accelerated by more than speed^2 / motion^2.
  const Real motion_square = dot6(moving, moving) / least_acceleration;
  bool damped = false;
  for (std::int32_t j = 0; j < joints; ++j) x[j] = 0;
  for (std::int32_t k = 0; k < r.rank; ++k) {
    const Real s = r.basis.s[k];
    if (!(s > Real{0})) continue;  // what is lost is not answered, as s / (s^2 + k^2) says
    const Real damping = damping_square(s, motion_square);
    if (damping > Real{0}) damped = true;
    const Real along = dot6(r.basis.us[k], even) / (s * s + damping);
    for (std::int32_t j = 0; j < joints; ++j) x[j] += along * r.basis.v[k][j] * r.unit[j];
  }
  Real share = 1;
  for (std::int32_t j = 0; j < joints; ++j) {
    if (magnitude(x[j]) * share > bound[j]) share = bound[j] / magnitude(x[j]);
  }
  for (std::int32_t j = 0; j < joints; ++j) {
    // The rounding of the share must not pass a bound.
    if (share < Real{1}) x[j] = clamp(-bound[j], share * x[j], bound[j]);
  }
  if (share < Real{1}) return damped ? Status::near_singular : Status::step_limited;
  Real missed = 0, size = 0;
  for (int k = 0; k < 6; ++k) {
    Real reached = 0;
    for (std::int32_t j = 0; j < joints; ++j) reached += jacobian.column[j][k] * x[j];
    if (k < 3) reached /= r.length_m;
    missed += (reached - even[k]) * (reached - even[k]);
    size += even[k] * even[k];
  }
  constexpr Real met = sizeof(Real) == sizeof(double) ? Real(1e-9) : Real(1e-4);
  if (missed <= met * met * size) return Status::ok;
  return damped || r.basis.s[r.rank - 1] < Real(0.01) ? Status::near_singular : Status::out_of_reach;
}

// Slows down what moves towards a joint limit. Returns whether one was.
bool keep_limits(const Arm<Real>& arm, const Real* q, Real* velocity) {
  constexpr Real approach_s = static_cast<Real>(limit_approach_s);
  bool limited = false;
  for (std::int32_t j = 0; j < arm.joint_count; ++j) {
    const std::uint32_t bit = 1U << static_cast<std::uint32_t>(j);
    Real low = -magnitude(velocity[j]), high = magnitude(velocity[j]);
    if ((arm.min_mask & bit) != 0U) low = clamp(low, (arm.min[j] - q[j]) / approach_s, Real{0});
    if ((arm.max_mask & bit) != 0U) high = clamp(Real{0}, (arm.max[j] - q[j]) / approach_s, high);
    const Real kept = clamp(low, velocity[j], high);
    if (kept < velocity[j] || kept > velocity[j]) limited = true;
    velocity[j] = kept;
  }
  return limited;
}

// dJ/dt of the joint coordinates times their rates: the flange's acceleration where no joint is accelerated. The derivative
// of column i by coordinate j, j <= i, is z_j x column i in both halves (z_j x z_i = 0 for i = j), and that of the
// linear half is symmetric in i and j (Hourtash 2005).
void velocity_product(const Jacobian<Real>& coordinates, const Real* rate, std::int32_t joints, Real* acceleration) {
  for (int k = 0; k < 6; ++k) acceleration[k] = 0;
  for (std::int32_t j = 0; j < joints; ++j) {
    const Real* axis = coordinates.column[j] + 3;
    for (std::int32_t i = j; i < joints; ++i) {
      const Real* column = coordinates.column[i];
      const Real product = rate[i] * rate[j];
      add_cross(axis, column, i == j ? product : Real{2} * product, acceleration);
      if (i > j) add_cross(axis, column + 3, product, acceleration + 3);
    }
  }
}

// The same where the transmission's terms bend the map too: by the Jacobian on both sides of the motion, 1e-4 rad (float 0.01)
// of the fastest joint away, where what the highest order leaves and the rounding are alike, a 1e-8 (float 1e-3) of it.
[[gnu::noinline]] void velocity_product_with_terms(const Arm<Real>& arm, const Real* q, const Real* velocity, Real* acceleration) {
  constexpr Real way = sizeof(Real) == sizeof(double) ? Real(1e-4) : Real(1e-2);
  Real fastest = 0;
  for (std::int32_t j = 0; j < arm.joint_count; ++j) {
    if (magnitude(velocity[j]) > fastest) fastest = magnitude(velocity[j]);
  }
  for (int k = 0; k < 6; ++k) acceleration[k] = 0;
  if (!(fastest > Real(1e-9))) return;
  const Real time = way / fastest;
  for (int n = 0; n < 2; ++n) {
    const Real side = n == 0 ? Real{1} : Real{-1};
    Real there[max_joints];
    for (std::int32_t j = 0; j < arm.joint_count; ++j) there[j] = q[j] + side * time * velocity[j];
    Frame<Real> frame;
    Jacobian<Real> jacobian;
    evaluate(arm, there, frame, jacobian);
    to_readings(arm, jacobian);
    for (std::int32_t j = 0; j < arm.joint_count; ++j) {
      const Real share = side * velocity[j] / (Real{2} * time);
      for (int k = 0; k < 6; ++k) acceleration[k] += share * jacobian.column[j][k];
    }
  }
}

}  // namespace

Status joint_velocities(const Arm<Real>& arm, const Real* q, const Real* flange_velocity,
                        const JointRateLimits<Real>& limits, Real* velocity) noexcept {
  if (!readings_valid(arm, q) || !all_within(flange_velocity, 6, Real(-1e6), Real(1e6)) ||
      !valid(limits, arm.joint_count)) {
    return Status::bad_input;
  }
  Frame<Real> frame;
  Jacobian<Real> jacobian;
  evaluate(arm, q, frame, jacobian);
  to_readings(arm, jacobian);
  Resolution r;
  prepare(arm, jacobian, r);
  Real found[max_joints];
  const Status status =
      resolve(r, jacobian, flange_velocity, flange_velocity, limits.max_acceleration, limits.max_velocity, found);
  const bool limited = keep_limits(arm, q, found);
  for (std::int32_t j = 0; j < arm.joint_count; ++j) velocity[j] = found[j];
  return limited ? Status::joint_limited : status;
}

Status joint_accelerations(const Arm<Real>& arm, const Real* q, const Real* velocity, const Real* flange_acceleration,
                           const JointRateLimits<Real>& limits, Real* acceleration) noexcept {
  if (!readings_valid(arm, q) || !all_within(velocity, arm.joint_count, Real(-1e6), Real(1e6)) ||
      !all_within(flange_acceleration, 6, Real(-1e6), Real(1e6)) || !valid(limits, arm.joint_count)) {
    return Status::bad_input;
  }
  Frame<Real> frame;
  Jacobian<Real> jacobian;
  evaluate(arm, q, frame, jacobian);
  Real rate[max_joints], product[6], wanted[6], motion[6];
  for (std::int32_t i = 0; i < arm.joint_count; ++i) {
    rate[i] = 0;
    for (std::int32_t j = 0; j < arm.joint_count; ++j) rate[i] += arm.map[i][j] * velocity[j];
  }
  if (arm.has_terms != 0) {
    velocity_product_with_terms(arm, q, velocity, product);
  } else {
    velocity_product(jacobian, rate, arm.joint_count, product);
  }
  for (int k = 0; k < 6; ++k) {
    wanted[k] = flange_acceleration[k] - product[k];
    motion[k] = 0;
    for (std::int32_t i = 0; i < arm.joint_count; ++i) motion[k] += jacobian.column[i][k] * rate[i];
  }
  to_readings(arm, jacobian);
  Resolution r;
  prepare(arm, jacobian, r);
  Real found[max_joints];
  const Status status =
      resolve(r, jacobian, wanted, motion, limits.max_acceleration, limits.max_acceleration, found);
  for (std::int32_t j = 0; j < arm.joint_count; ++j) acceleration[j] = found[j];
  return status;
}

}  // namespace mdhcal
