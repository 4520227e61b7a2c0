// SPDX-License-Identifier: MIT
#include "mdhcal/self_test.hpp"

#include <string.h>

#include "mdhcal/inverse.hpp"
#include "mdhcal/kinematics.hpp"
#include "number/compare.hpp"
#include "number/real.hpp"

namespace mdhcal {

namespace {

// What a precision takes from a model.
template <class Precision>
struct Share {
  const SelfTestVector<Precision>* vector;
  std::int32_t count;
  Precision position_tolerance_m, rotation_tolerance_rad;
  Precision bound;
};

template <class Precision>
Share<Precision> share_of(const BlobContent& model) {
  const Tolerances& tolerances = model.tolerances;
  if constexpr (sizeof(Precision) == sizeof(double)) {
    return {model.double_vector, model.double_vector_count, tolerances.position_m, tolerances.rotation_rad,
            self_test_bound};
  } else {
    return {model.float_vector, model.float_vector_count, tolerances.float_position_m, tolerances.float_rotation_rad,
            self_test_bound_float};
  }
}

// Whether the compiler computes what is written: it may not regroup sums, divide by multiplying, fuse a product and a sum, or
// take it that there are no NaN, infinities and negative zeros. Not every compiler says that it was told to (real.hpp).
bool computes_as_written() {
  volatile Real given[] = {Real{1}, Real{5}, Real{3}, static_cast<Real>(sizeof(Real) == sizeof(double) ? 0x1p-30 : 0x1p-15),
                           -Real{0}, static_cast<Real>(__builtin_inf()), static_cast<Real>(__builtin_nan(""))};
  const Real one = given[0];
  const Real small = given[3];
  const Real tiny = small * small * small;  // lost beside 1
  const Real regrouped = (one + tiny) - one;
  const Real fused = (one + small) * (one - small) - one;  // exactly -small^2, which rounds away only before the sum
  const Real quotient = given[1] / Real{3};                // 5 (1 / 3) rounds otherwise, and 5 / 3 at compile time does not
  volatile Real divided = given[1] / given[2];
  const Real zero = given[4] + Real{0};
  const Real infinite = given[5];
  const Real undefined = given[6];
  return within_bound(regrouped, Real{0}) && within_bound(fused, Real{0}) && within_bound(quotient - divided, Real{0}) &&
         !__builtin_signbit(zero) && __builtin_isinf(infinite) && __builtin_isnan(undefined);
}

bool near(const Pose<Real>& a, const Pose<Real>& b, Real bound) {
  for (int k = 0; k < 3; ++k) {
    if (!within_bound(a.position_m[k] - b.position_m[k], bound)) return false;
  }
  // The vector part of conj(a) b is sin(angle / 2) times the axis.
  const Real* p = a.quaternion;
  const Real* q = b.quaternion;
  const Real x = (p[0] * q[1] - p[1] * q[0]) - (p[2] * q[3] - p[3] * q[2]);
  const Real y = (p[0] * q[2] - p[2] * q[0]) - (p[3] * q[1] - p[1] * q[3]);
  const Real z = (p[0] * q[3] - p[3] * q[0]) - (p[1] * q[2] - p[2] * q[1]);
  return Real{4} * (x * x + y * y + z * z) <= bound * bound;
}

Status run(const SelfTestVector<Real>& vector, const Arm<Real>& arm, const Share<Real>& share, bool bits) {
  Pose<Real> pose;
  if (forward(arm, vector.q, pose) != Status::ok) return Status::self_test_failed;
  Real q[max_joints] = {};
  for (std::int32_t i = 0; i < arm.joint_count; ++i) {
    constexpr Real offset = static_cast<Real>(self_test_offset);
    q[i] = vector.q[i] + (i % 2 == 0 ? offset : -offset);
  }
  TickOptions<Real> options = default_tick_options(arm);
  options.goal.position_tolerance_m = share.position_tolerance_m;
  options.goal.rotation_tolerance_rad = share.rotation_tolerance_rad;
  const Status status = tick(arm, options, vector.base_T_flange, q);
  bool passed = true;
  if (bits) {
    passed = static_cast<std::int32_t>(status) == vector.inverse_status &&
             memcmp(pose.quaternion, vector.base_T_flange.quaternion, sizeof pose.quaternion) == 0 &&
             memcmp(pose.position_m, vector.base_T_flange.position_m, sizeof pose.position_m) == 0 &&
             memcmp(q, vector.inverse_q, sizeof q) == 0;
  } else {
    passed = near(pose, vector.base_T_flange, share.bound);
    // Where the host's inverse did not arrive, another arithmetic need not stop in the same place.
    if (vector.inverse_status == static_cast<std::int32_t>(Status::ok)) {
      passed = passed && status == Status::ok;
      for (std::size_t i = 0; i < max_joints; ++i) passed = passed && within_bound(q[i] - vector.inverse_q[i], share.bound);
    }
  }
  return passed ? Status::ok : Status::self_test_failed;
}

}  // namespace

Status self_test(const BlobContent& model, const Arm<Real>& arm) noexcept {
  const Share<Real> share = share_of<Real>(model);
  if (share.count < 1 || share.count > static_cast<std::int32_t>(max_vectors)) return Status::self_test_failed;
  if (!computes_as_written()) return Status::self_test_failed;
  const bool bits = model.arithmetic_id == arithmetic_id;
  for (std::int32_t i = 0; i < share.count; ++i) {
    if (run(share.vector[i], arm, share, bits) != Status::ok) return Status::self_test_failed;
  }
  return bits ? Status::ok : Status::self_test_tolerance;
}

}  // namespace mdhcal
