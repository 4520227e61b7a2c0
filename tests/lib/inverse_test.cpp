// SPDX-License-Identifier: MIT
#include "mdhcal/inverse.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "mdhcal/kinematics.hpp"
#include "tests/lib/arms.hpp"
#include "tests/support/exceptions.hpp"

namespace {

using namespace mdhcal;
using namespace mdhcal::test;

template <class Real>
Real largest_difference(const Real* a, const Real* b, int count) {
  Real largest = 0;
  for (int i = 0; i < count; ++i) largest = std::max(largest, std::fabs(a[i] - b[i]));
  return largest;
}

template <class Real>
struct RegularCase {
  Real q[6];
  Pose<Real> target;
};

// A pose away from singularities, so that a seed 0.05 rad away is on the same side of all of them.
template <class Real>
RegularCase<Real> regular_case(const Arm<Real>& arm, Random& random) {
  for (;;) {
    RegularCase<Real> found{};
    for (Real& q : found.q) q = static_cast<Real>(random.symmetric(pi));
    EXPECT_EQ(forward(arm, found.q, found.target), Status::ok);
    TickReport<Real> report{};
    Real q[6];
    std::copy(found.q, found.q + 6, q);
    EXPECT_EQ(tick(arm, default_tick_options(arm), found.target, q, &report), Status::ok);
    if (report.smallest_singular_value > Real(0.03)) return found;
  }
}

template <class Real>
class Tick : public ::testing::Test {};
using Reals = ::testing::Types<double, float>;
TYPED_TEST_SUITE(Tick, Reals, );

TYPED_TEST(Tick, MeetsEveryRegularPoseFromANearSeed) {
  using Real = TypeParam;
  const bool is_double = sizeof(Real) == sizeof(double);
  Random random(4);
  Arm<Real> arm{};
  for (int n = 0; n < cases(100000); ++n) {
    if (n % 100 == 0) {
      const Geometry nominal = n % 200 == 0 ? ur5() : wrist_arm();
      ASSERT_EQ(make_arm(with_errors(nominal, random, 1e-3, 0.1 * deg), arm), Status::ok);
    }
    const RegularCase<Real> truth = regular_case(arm, random);
    Real q[6];
    for (int i = 0; i < 6; ++i) q[i] = truth.q[i] + static_cast<Real>(random.symmetric(0.05));
    ASSERT_EQ(tick(arm, default_tick_options(arm), truth.target, q), Status::ok) << n;
    ASSERT_LT(largest_difference(q, truth.q, 6), is_double ? Real(1e-8) : Real(2e-3)) << n;
    Pose<Real> reached{};
    ASSERT_EQ(forward(arm, q, reached), Status::ok);
    const Real tolerance = is_double ? Real(1.001e-10) : Real(5.5e-6);
    Real square = 0;
    for (int k = 0; k < 3; ++k) {
      const Real difference = reached.position_m[k] - truth.target.position_m[k];
      square += difference * difference;
    }
    ASSERT_LE(std::sqrt(square), tolerance) << n;
    // Twice the difference of unit quaternions is the angle between them; near a half turn their signs may differ.
    Real same = 0;
    Real opposite = 0;
    for (int k = 0; k < 4; ++k) {
      const Real a = reached.quaternion[k];
      const Real b = truth.target.quaternion[k];
      same += (a - b) * (a - b);
      opposite += (a + b) * (a + b);
    }
    ASSERT_LE(Real{2} * std::sqrt(std::min(same, opposite)), tolerance) << n;
  }
}

TYPED_TEST(Tick, LeavesTheJointsAloneOnBadInput) {
  using Real = TypeParam;
  Arm<Real> arm{};
  ASSERT_EQ(make_arm(ur5(), arm), Status::ok);
  const Real joints[6] = {Real(0.1), Real(-1.2), Real(1.4), Real(0.3), Real(0.7), Real(-0.2)};
  Pose<Real> target{};
  ASSERT_EQ(forward(arm, joints, target), Status::ok);
  const Real bad[] = {std::numeric_limits<Real>::quiet_NaN(), std::numeric_limits<Real>::infinity(),
                      -std::numeric_limits<Real>::infinity(), std::numeric_limits<Real>::max()};
  for (const Real value : bad) {
    for (int slot = 0; slot < 13; ++slot) {
      Real q[6];
      std::copy(joints, joints + 6, q);
      Pose<Real> pose = target;
      if (slot < 6) {
        q[slot] = value;
      } else if (slot < 10) {
        pose.quaternion[slot - 6] = value;
      } else {
        pose.position_m[slot - 10] = value;
      }
      Real before[6];
      std::copy(q, q + 6, before);
      const TickOptions<Real> options = default_tick_options(arm);
      clear_exceptions();
      EXPECT_EQ(tick(arm, options, pose, q), Status::bad_input) << slot;
      EXPECT_FALSE(exceptions_raised()) << slot;
      for (int i = 0; i < 6; ++i) {
        if (i != slot) {
          EXPECT_EQ(q[i], before[i]);
        }
      }
    }
  }
}

// Regular, singular and unreachable targets, from exactly singular joints too: nothing that traps where that is enabled.
TYPED_TEST(Tick, RaisesNoExceptionThatTraps) {
  using Real = TypeParam;
  Random random(6);
  Arm<Real> arms[2] = {};
  ASSERT_EQ(make_arm(ur5(), arms[0]), Status::ok);
  ASSERT_EQ(make_arm(with_errors(ur5(), random, 1e-3, 0.1 * deg), arms[1]), Status::ok);
  for (int n = 0; n < cases(20000); ++n) {
    const Arm<Real>& arm = arms[n / 2 % 2];
    const TickOptions<Real> options = default_tick_options(arm);
    Real q[6];
    for (Real& joint : q) joint = static_cast<Real>(random.symmetric(pi));
    if (n % 3 == 0) q[4] = 0;
    if (n % 5 == 0) q[2] = 0;
    Pose<Real> target{};
    ASSERT_EQ(forward(arm, q, target), Status::ok);
    if (n % 2 == 0) {
      for (Real& x : target.position_m) x *= Real(1.5);
    }
    if (n % 7 != 0) {
      for (Real& joint : q) joint += static_cast<Real>(random.symmetric(0.003));
    }
    clear_exceptions();
    ASSERT_NE(tick(arm, options, target, q), Status::bad_input) << n;
    ASSERT_FALSE(exceptions_raised()) << n;
  }
}

TYPED_TEST(Tick, KeepsTheStepLimitForTheWholeTick) {
  using Real = TypeParam;
  Random random(5);
  Arm<Real> arm{};
  ASSERT_EQ(make_arm(with_errors(ur5(), random, 1e-3, 0.1 * deg), arm), Status::ok);
  TickOptions<Real> options = default_tick_options(arm);
  for (int i = 0; i < 6; ++i) options.limits.max_step[i] = Real(0.00314);
  for (int n = 0; n < cases(20000); ++n) {
    const RegularCase<Real> truth = regular_case(arm, random);
    Real q[6];
    Real last[6];
    for (int i = 0; i < 6; ++i) last[i] = q[i] = truth.q[i] + static_cast<Real>(random.symmetric(0.3));
    TickReport<Real> report{};
    const Status status = tick(arm, options, truth.target, q, &report);
    ASSERT_LE(largest_difference(q, last, 6), Real(0.00314)) << n;
    ASSERT_NE(status, Status::bad_input);
    if (status == Status::step_limited) {
      ASSERT_NE(report.step_mask, 0U);
    }
  }
}

}  // namespace
