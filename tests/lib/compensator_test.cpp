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
class OfTheCompensator : public ::testing::Test {
 protected:
  void SetUp() override {
    Random random(31);
    ASSERT_EQ(make_calibrated_arm(ur5(), with_errors(ur5(), random, 1e-3, 0.1 * deg), model), Status::ok);
    options = default_tick_options(model.corrected);
    for (int i = 0; i < 6; ++i) options.limits.max_step[i] = Real(0.00314);
    ASSERT_EQ(forward(model.nominal, start, target), Status::ok);
    tolerance = Real(1.01) * options.goal.position_tolerance_m;
  }
  Compensator<Real> at_rest(Model which) {
    Compensator<Real> made{};
    EXPECT_EQ(start_at_rest(model, which, made), Status::ok);
    return made;
  }
  CalibratedArm<Real> model{};
  TickOptions<Real> options{};
  const Real start[6] = {Real(0.3), Real(-1.2), Real(1.5), Real(0.4), Real(1.1), Real(-0.6)};
  Pose<Real> target{};
  Real tolerance = 0;
};
using Reals = ::testing::Types<double, float>;
TYPED_TEST_SUITE(OfTheCompensator, Reals, );

TYPED_TEST(OfTheCompensator, RampsWithoutAJumpAndEndsOnTheModel) {
  using Real = TypeParam;
  Compensator<Real> state = this->at_rest(Model::nominal);
  Real q[6];
  std::copy(this->start, this->start + 6, q);
  ASSERT_EQ(pose_to_joints(state, this->options, this->target, q), Status::ok);
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(q[i], this->start[i], 1e-5);
  Real first[6];
  std::copy(q, q + 6, first);
  for (const bool corrected : {true, false}) {
    ASSERT_EQ(start_ramp(state, this->model, corrected ? Model::corrected : Model::nominal, 500), Status::ok);
    Real largest = 0;
    for (int n = 0; n < 600; ++n) {
      ASSERT_EQ(advance_ramp(state), Status::ok);
      Real last[6];
      std::copy(q, q + 6, last);
      ASSERT_EQ(pose_to_joints(state, this->options, this->target, q), Status::ok);
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

TYPED_TEST(OfTheCompensator, JointsThatTheControllerFoundAreMadeTrue) {
  using Real = TypeParam;
  const Compensator<Real> state = this->at_rest(Model::corrected);
  Real q[6];
  std::copy(this->start, this->start + 6, q);
  TickOptions<Real> free = default_tick_options(this->model.corrected);
  ASSERT_EQ(joints_to_joints(state, free, this->start, q), Status::ok);
  Pose<Real> reached{};
  ASSERT_EQ(forward(this->model.corrected, q, reached), Status::ok);
  EXPECT_LE(position_distance(reached, this->target), this->tolerance);
}

// A controller that keeps its nominal model inverts the command by that model; the arm as it is then stands at the target.
TYPED_TEST(OfTheCompensator, CommandedPoseMakesTheNominalControllerArrive) {
  using Real = TypeParam;
  const Compensator<Real> state = this->at_rest(Model::corrected);
  TickOptions<Real> free = default_tick_options(this->model.corrected);
  Real q[6];
  std::copy(this->start, this->start + 6, q);
  Pose<Real> command{};
  ASSERT_EQ(pose_to_pose(state, free, this->target, q, command), Status::ok);
  EXPECT_GT(position_distance(command, this->target), Real(1e-5));
  Real controller_q[6];
  std::copy(this->start, this->start + 6, controller_q);
  ASSERT_EQ(tick(this->model.nominal, free, command, controller_q), Status::ok);
  Pose<Real> reached{};
  ASSERT_EQ(forward(this->model.corrected, controller_q, reached), Status::ok);
  EXPECT_LE(position_distance(reached, this->target), Real{4} * this->tolerance);
}

TYPED_TEST(OfTheCompensator, VelocitiesAreThoseOfTheForwardModel) {
  using Real = TypeParam;
  const Real wanted[6] = {Real(0.1), Real(-0.2), Real(0.05), Real(0.3), Real(0.1), Real(-0.2)};
  JointRateLimits<Real> limit{};
  std::fill(limit.max_velocity, limit.max_velocity + 6, Real(10));
  std::fill(limit.max_acceleration, limit.max_acceleration + 6, Real(1000));
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
  std::fill(limit.max_velocity, limit.max_velocity + 6, Real(0.05));
  EXPECT_EQ(joint_velocities(this->model.corrected, this->start, wanted, limit, velocity), Status::step_limited);
  for (const Real v : velocity) EXPECT_LE(std::fabs(v), Real(0.05));
  const Real straight[6] = {Real(0.3), Real(-1.2), Real(1.5), Real(0.4), Real(0), Real(-0.6)};
  EXPECT_EQ(joint_velocities(this->model.nominal, straight, wanted, limit, velocity), Status::near_singular);
  Real bad[6];
  std::copy(wanted, wanted + 6, bad);
  bad[3] = std::numeric_limits<Real>::quiet_NaN();
  EXPECT_EQ(joint_velocities(this->model.corrected, this->start, bad, limit, velocity), Status::bad_input);
}

TYPED_TEST(OfTheCompensator, RefusesWhatDoesNotFit) {
  using Real = TypeParam;
  CalibratedArm<Real> other{};
  EXPECT_EQ(make_calibrated_arm(ur5(), seven_joint_arm(), other), Status::bad_input);
  Geometry turned = ur5();
  turned.joint[2].sign = -1;
  EXPECT_EQ(make_calibrated_arm(ur5(), turned, other), Status::bad_input);
  Compensator<Real> state{};
  EXPECT_EQ(advance_ramp(state), Status::bad_input);
  EXPECT_EQ(start_ramp(state, this->model, Model::corrected, 10), Status::bad_input);
  EXPECT_EQ(start_at_rest(CalibratedArm<Real>{}, Model::corrected, state), Status::bad_input);
  EXPECT_EQ(start_at_rest(this->model, static_cast<Model>(2), state), Status::bad_input);
  state = this->at_rest(Model::corrected);
  ASSERT_EQ(make_calibrated_arm(seven_joint_arm(), seven_joint_arm(), other), Status::ok);
  EXPECT_EQ(start_ramp(state, other, Model::corrected, 10), Status::bad_input);
  EXPECT_EQ(start_ramp(state, this->model, static_cast<Model>(-1), 10), Status::bad_input);
}

TEST(Environment, IsTheDefaultHere) { EXPECT_EQ(check_environment(), Status::ok); }

}  // namespace
