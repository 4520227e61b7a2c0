// SPDX-License-Identifier: MIT
#include "mdhcal/compensator.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "mdhcal/environment.hpp"
#include "tests/lib/poses.hpp"

namespace {

using namespace mdhcal;
using namespace mdhcal::test;

template <class Real>
class Compensator : public ::testing::Test {
 protected:
  void SetUp() override {
    Random random(31);
    ASSERT_EQ(make_compensator(ur5(), with_errors(ur5(), random, 1e-3, 0.1 * deg), model), Status::ok);
    options = default_tick_options(model.corrected);
    for (int i = 0; i < 6; ++i) options.limits.max_step[i] = Real(0.00314);
    ASSERT_EQ(forward(model.nominal, start, target), Status::ok);
    tolerance = Real(1.01) * options.goal.position_tolerance_m;
  }
  CompensatorModel<Real> model{};
  TickOptions<Real> options{};
  const Real start[6] = {Real(0.3), Real(-1.2), Real(1.5), Real(0.4), Real(1.1), Real(-0.6)};
  Pose<Real> target{};
  Real tolerance = 0;
};
using Reals = ::testing::Types<double, float>;
TYPED_TEST_SUITE(Compensator, Reals, );

TYPED_TEST(Compensator, RampsWithoutAJumpAndEndsOnTheModel) {
  using Real = TypeParam;
  CompensatorState<Real> state = rest(this->model, false);
  Real q[6];
  std::copy(this->start, this->start + 6, q);
  ASSERT_EQ(pose_to_joints(this->model, state, this->options, this->target, q), Status::ok);
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(q[i], this->start[i], 1e-5);
  Real first[6];
  std::copy(q, q + 6, first);
  for (const bool corrected : {true, false}) {
    ASSERT_EQ(start_ramp(state, corrected, Real(0.5)), Status::ok);
    Real largest = 0;
    for (int n = 0; n < 600; ++n) {
      ASSERT_EQ(advance(state, Real(0.001)), Status::ok);
      Real last[6];
      std::copy(q, q + 6, last);
      ASSERT_EQ(pose_to_joints(this->model, state, this->options, this->target, q), Status::ok);
      for (int i = 0; i < 6; ++i) largest = std::max(largest, std::fabs(q[i] - last[i]));
    }
    // About 0.01 rad in all, 500 ticks, at most 1.5 times the mean at the middle.
    EXPECT_LT(largest, Real(1e-4));
    Pose<Real> reached{};
    ASSERT_EQ(forward(corrected ? this->model.corrected : this->model.nominal, q, reached), Status::ok);
    EXPECT_LE(position_distance(reached, this->target), this->tolerance);
    EXPECT_LE(small_angle(reached, this->target), this->tolerance);
  }
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(q[i], first[i], 2e-5);
}

TYPED_TEST(Compensator, JointsThatTheControllerFoundAreMadeTrue) {
  using Real = TypeParam;
  const CompensatorState<Real> state = rest(this->model, true);
  Real q[6];
  std::copy(this->start, this->start + 6, q);
  TickOptions<Real> free = default_tick_options(this->model.corrected);
  ASSERT_EQ(joints_to_joints(this->model, state, free, this->start, q), Status::ok);
  Pose<Real> reached{};
  ASSERT_EQ(forward(this->model.corrected, q, reached), Status::ok);
  EXPECT_LE(position_distance(reached, this->target), this->tolerance);
}

// A controller that keeps its nominal model inverts the command by that model; the arm as it is then stands at the target.
TYPED_TEST(Compensator, CommandedPoseMakesTheNominalControllerArrive) {
  using Real = TypeParam;
  const CompensatorState<Real> state = rest(this->model, true);
  TickOptions<Real> free = default_tick_options(this->model.corrected);
  Real q[6];
  std::copy(this->start, this->start + 6, q);
  Pose<Real> command{};
  ASSERT_EQ(pose_to_pose(this->model, state, free, this->target, q, command), Status::ok);
  EXPECT_GT(position_distance(command, this->target), Real(1e-5));
  Real controller_q[6];
  std::copy(this->start, this->start + 6, controller_q);
  ASSERT_EQ(tick(this->model.nominal, free, command, controller_q), Status::ok);
  Pose<Real> reached{};
  ASSERT_EQ(forward(this->model.corrected, controller_q, reached), Status::ok);
  EXPECT_LE(position_distance(reached, this->target), Real{4} * this->tolerance);
}

TYPED_TEST(Compensator, VelocitiesAreThoseOfTheForwardModel) {
  using Real = TypeParam;
  const Real wanted[6] = {Real(0.1), Real(-0.2), Real(0.05), Real(0.3), Real(0.1), Real(-0.2)};
  Real limit[6];
  std::fill(limit, limit + 6, Real(10));
  Real velocity[6];
  ASSERT_EQ(joint_velocities(this->model.corrected, this->start, wanted, limit, velocity), Status::ok);
  // Central difference of the position along the velocity, in double.
  Arm<double> arm{};
  Random random(31);
  ASSERT_EQ(make_arm(with_errors(ur5(), random, 1e-3, 0.1 * deg), arm), Status::ok);
  const double h = 1e-5;
  double ahead[6];
  double behind[6];
  for (int i = 0; i < 6; ++i) {
    ahead[i] = static_cast<double>(this->start[i]) + h * static_cast<double>(velocity[i]);
    behind[i] = static_cast<double>(this->start[i]) - h * static_cast<double>(velocity[i]);
  }
  Pose<double> a{};
  Pose<double> b{};
  ASSERT_EQ(forward(arm, ahead, a), Status::ok);
  ASSERT_EQ(forward(arm, behind, b), Status::ok);
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR((a.position_m[k] - b.position_m[k]) / (2 * h), static_cast<double>(wanted[k]),
                sizeof(Real) == 8 ? 1e-8 : 1e-5);
  }
  std::fill(limit, limit + 6, Real(0.05));
  EXPECT_EQ(joint_velocities(this->model.corrected, this->start, wanted, limit, velocity), Status::step_limited);
  for (const Real v : velocity) EXPECT_LE(std::fabs(v), Real(0.05));
  const Real straight[6] = {Real(0.3), Real(-1.2), Real(1.5), Real(0.4), Real(0), Real(-0.6)};
  EXPECT_EQ(joint_velocities(this->model.nominal, straight, wanted, limit, velocity), Status::near_singular);
  Real bad[6];
  std::copy(wanted, wanted + 6, bad);
  bad[3] = std::numeric_limits<Real>::quiet_NaN();
  EXPECT_EQ(joint_velocities(this->model.corrected, this->start, bad, limit, velocity), Status::bad_input);
}

TYPED_TEST(Compensator, RefusesWhatDoesNotFit) {
  using Real = TypeParam;
  CompensatorModel<Real> other{};
  EXPECT_EQ(make_compensator(ur5(), seven_joint_arm(), other), Status::bad_input);
  Geometry turned = ur5();
  turned.joint[2].sign = -1;
  EXPECT_EQ(make_compensator(ur5(), turned, other), Status::bad_input);
  CompensatorState<Real> state = rest(this->model, true);
  EXPECT_EQ(start_ramp(state, true, Real(-1)), Status::bad_input);
  EXPECT_EQ(advance(state, std::numeric_limits<Real>::quiet_NaN()), Status::bad_input);
  state.progress = std::numeric_limits<Real>::quiet_NaN();
  Real q[6];
  std::copy(this->start, this->start + 6, q);
  EXPECT_EQ(pose_to_joints(this->model, state, this->options, this->target, q), Status::bad_input);
}

TEST(Environment, IsTheDefaultHere) { EXPECT_EQ(check_environment(), Status::ok); }

}  // namespace
