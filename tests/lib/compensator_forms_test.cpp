// SPDX-License-Identifier: MIT
// The three forms and the velocities against the product of the factors in long double, on arms of five to eight joints;
// ramps that run into the step limit or turn back.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "mdhcal/compensator.hpp"
#include "tests/lib/every_solution.hpp"
#include "tests/lib/factors.hpp"

namespace {

using namespace mdhcal;
using namespace mdhcal::test;

// A seven-joint arm on a rail.
Geometry eight_joint_arm() {
  Geometry g = from_table({{90, 0, 0, 0}, {-90, 0, 0, 0.36}, {-90, 0, 0, 0}, {90, 0, 0, 0.42}, {90, 0, 0, 0},
                           {-90, 0, 0, 0.4}, {-90, 0, 0, 0}, {90, 0, 0, 0.126}});
  g.joint[0].kind = JointKind::prismatic;
  return g;
}

struct Kind {
  Geometry nominal;
  Task task;
};

std::vector<Kind> kinds() {
  Geometry coupled = wrist_arm();
  coupled.joint[2].sign = -1;
  coupled.joint[2].coupling[1] = -1.5;
  return {{five_joint_arm(), Task::position}, {ur5(), Task::pose},            {wrist_arm(), Task::pose},
          {coupled, Task::pose},                   {seven_joint_arm(), Task::pose}, {eight_joint_arm(), Task::pose}};
}

// What the task asks for, of two poses as matrices.
Distance between(const Matrix& a, const Matrix& b, Task task) {
  long double position = 0;
  long double rotation = 0;
  for (int i = 0; i < 3; ++i) {
    position += (a.m[i][3] - b.m[i][3]) * (a.m[i][3] - b.m[i][3]);
    for (int j = 0; j < 3; ++j) rotation += (a.m[i][j] - b.m[i][j]) * (a.m[i][j] - b.m[i][j]);
  }
  return {static_cast<double>(std::sqrt(position)),
          task == Task::position ? 0.0 : static_cast<double>(std::sqrt(rotation / 2))};
}

template <class Real>
class Forms : public ::testing::Test {
 protected:
  static constexpr bool is_double = sizeof(Real) == sizeof(double);
  static constexpr double tolerance = is_double ? 1.1e-10 : 7e-6;

  // Regular joints: every other one bent the other way, away from singularities of the whole pose if there are six.
  void draw(const Geometry& g, Random& random, Real* q) {
    Arm<double> arm{};
    ASSERT_EQ(make_arm(g, arm), Status::ok);
    double joints[max_joints] = {};
    do {
      for (int i = 0; i < g.joint_count; ++i) joints[i] = (i % 2 == 0 ? 1 : -1) * random.uniform(0.4, 1.2);
    } while (g.joint_count == 6 && smallest_singular_value(arm, joints) < 0.03);
    for (int i = 0; i < g.joint_count; ++i) q[i] = static_cast<Real>(joints[i]);
  }
};
using Reals = ::testing::Types<double, float>;
TYPED_TEST_SUITE(Forms, Reals, );

TYPED_TEST(Forms, AreTrueOfArmsOfFiveToEightJoints) {
  using Real = TypeParam;
  Random random(91);
  for (const Kind& kind : kinds()) {
    for (int n = 0; n < cases(100); ++n) {
      const Geometry corrected = with_errors(kind.nominal, random, 1e-3, 0.1 * deg);
      CalibratedArm<Real> model{};
      ASSERT_EQ(make_calibrated_arm(kind.nominal, corrected, model), Status::ok);
      Compensator<Real> state{};
      ASSERT_EQ(start_at_rest(model, Model::corrected, state), Status::ok);
      TickOptions<Real> options = default_tick_options(model.corrected);
      options.goal.task = kind.task;
      Real nominal_q[max_joints] = {};
      this->draw(kind.nominal, random, nominal_q);
      const Matrix meant = product_of_factors(kind.nominal, nominal_q);
      Pose<Real> target{};
      ASSERT_EQ(forward(model.nominal, nominal_q, target), Status::ok);
      const auto expect_there = [&](const Geometry& geometry, const Real* q, const char* form) {
        const Distance missed = between(product_of_factors(geometry, q), meant, kind.task);
        EXPECT_LE(missed.position_m, this->tolerance) << form << ", joints " << kind.nominal.joint_count;
        EXPECT_LE(missed.rotation_rad, this->tolerance) << form << ", joints " << kind.nominal.joint_count;
      };
      Real q[max_joints];
      std::copy(nominal_q, nominal_q + max_joints, q);
      ASSERT_EQ(pose_to_joints(state, options, target, q), Status::ok)
          << n << ", joints " << kind.nominal.joint_count;
      expect_there(corrected, q, "first");
      Real second[max_joints];
      std::copy(nominal_q, nominal_q + max_joints, second);
      ASSERT_EQ(joints_to_joints(state, options, nominal_q, second), Status::ok);
      expect_there(corrected, second, "second");
      Real third[max_joints];
      std::copy(nominal_q, nominal_q + max_joints, third);
      Pose<Real> command{};
      ASSERT_EQ(pose_to_pose(state, options, target, third, command), Status::ok);
      expect_there(corrected, third, "third");
      // The nominal controller's joints for the command are `third`, if it has an inverse at all.
      const Distance off = distance(product_of_factors(kind.nominal, third), command);
      EXPECT_LE(off.position_m, TestFixture::is_double ? 1e-12 : 2e-6);
      EXPECT_LE(off.rotation_rad, TestFixture::is_double ? 1e-12 : 2e-6);
      // At rest on the nominal model nothing is corrected.
      Compensator<Real> off_state{};
      ASSERT_EQ(start_at_rest(model, Model::nominal, off_state), Status::ok);
      std::copy(nominal_q, nominal_q + max_joints, q);
      ASSERT_EQ(joints_to_joints(off_state, options, nominal_q, q), Status::ok);
      for (int i = 0; i < kind.nominal.joint_count; ++i) EXPECT_NEAR(q[i], nominal_q[i], 1e-6);
    }
  }
}

// The middle of the ramp is the mean of both models, and its ends are flat: the first and the last of 1000 ticks move a
// hundredth of what the middle one does.
TYPED_TEST(Forms, RampBeginsAndEndsWithoutAChangeOfVelocity) {
  using Real = TypeParam;
  Random random(93);
  const Geometry corrected = with_errors(ur5(), random, 5e-3, 0.5 * deg);
  CalibratedArm<Real> model{};
  ASSERT_EQ(make_calibrated_arm(ur5(), corrected, model), Status::ok);
  Compensator<Real> state{};
  ASSERT_EQ(start_at_rest(model, Model::nominal, state), Status::ok);
  const TickOptions<Real> options = default_tick_options(model.corrected);
  Real q[max_joints] = {};
  this->draw(ur5(), random, q);
  Pose<Real> target{};
  ASSERT_EQ(forward(model.nominal, q, target), Status::ok);
  ASSERT_EQ(start_ramp(state, model, Model::corrected, 1000), Status::ok);
  double step[10] = {};
  for (int tenth = 0; tenth < 10; ++tenth) {
    for (int k = 0; k < 100; ++k) {
      Real last[6];
      std::copy(q, q + 6, last);
      ASSERT_EQ(advance_ramp(state), Status::ok);
      ASSERT_EQ(pose_to_joints(state, options, target, q), Status::ok);
      for (int i = 0; i < 6; ++i) step[tenth] += std::fabs(static_cast<double>(q[i] - last[i]));
    }
  }
  // s^3 (10 - 15 s + 6 s^2) covers 0.00856 in the first tenth and 0.18256 in the fifth.
  EXPECT_NEAR(step[0] / step[4], 0.00856 / 0.18256, TestFixture::is_double ? 0.02 : 0.1);
  EXPECT_NEAR(step[9] / step[4], 0.00856 / 0.18256, TestFixture::is_double ? 0.02 : 0.1);
}

struct Velocity {
  long double along[6];
};

// Of the flange, by central differences of the product of the factors.
template <class Real>
Velocity velocity_of(const Geometry& g, const Real* q, const Real* rate) {
  // Where a long double is a double, rounding asks for the longer step.
  constexpr long double h = sizeof(long double) > sizeof(double) ? 1e-6L : 1e-5L;
  long double ahead[max_joints] = {};
  long double behind[max_joints] = {};
  long double here[max_joints] = {};
  for (int i = 0; i < g.joint_count; ++i) {
    here[i] = static_cast<long double>(q[i]);
    ahead[i] = here[i] + h * static_cast<long double>(rate[i]);
    behind[i] = here[i] - h * static_cast<long double>(rate[i]);
  }
  const Matrix a = product_of_factors(g, ahead);
  const Matrix b = product_of_factors(g, behind);
  const Matrix r = product_of_factors(g, here);
  long double spin[3][3] = {};  // dR R^T
  Velocity v{};
  for (int i = 0; i < 3; ++i) {
    v.along[i] = (a.m[i][3] - b.m[i][3]) / (2 * h);
    for (int j = 0; j < 3; ++j) {
      for (int k = 0; k < 3; ++k) spin[i][j] += (a.m[i][k] - b.m[i][k]) / (2 * h) * r.m[j][k];
    }
  }
  v.along[3] = 0.5L * (spin[2][1] - spin[1][2]);
  v.along[4] = 0.5L * (spin[0][2] - spin[2][0]);
  v.along[5] = 0.5L * (spin[1][0] - spin[0][1]);
  return v;
}

TYPED_TEST(Forms, VelocitiesAreThoseOfTheProductOfTheFactors) {
  using Real = TypeParam;
  Random random(94);
  for (const Kind& kind : kinds()) {
    for (int n = 0; n < cases(50); ++n) {
      const Geometry g = with_errors(kind.nominal, random, 1e-3, 0.1 * deg);
      Arm<Real> arm{};
      ASSERT_EQ(make_arm(g, arm), Status::ok);
      Real q[max_joints] = {};
      Real rate[max_joints] = {};
      this->draw(g, random, q);
      for (int i = 0; i < g.joint_count; ++i) rate[i] = static_cast<Real>(random.symmetric(0.5));
      const Velocity wanted = velocity_of(g, q, rate);
      Real asked[6];
      for (int k = 0; k < 6; ++k) asked[k] = static_cast<Real>(wanted.along[k]);
      JointRateLimits<Real> limit{};
      std::fill(limit.max_velocity, limit.max_velocity + max_joints, Real(100));
      // So much that nothing is damped here.
      std::fill(limit.max_acceleration, limit.max_acceleration + max_joints, Real(1e6));
      Real found[max_joints] = {};
      ASSERT_EQ(joint_velocities(arm, q, asked, limit, found), Status::ok) << g.joint_count;
      const Velocity reached = velocity_of(g, q, found);
      for (int k = 0; k < 6; ++k) {
        EXPECT_NEAR(static_cast<double>(reached.along[k] - wanted.along[k]), 0, TestFixture::is_double ? 2e-9 : 1e-4);
      }
      // Where the joints say it all, they are the same; where they are redundant, smaller.
      double size_found = 0;
      double size_given = 0;
      for (int i = 0; i < g.joint_count; ++i) {
        const double unit = g.joint[i].kind == JointKind::prismatic ? 1 / static_cast<double>(arm.reach_m) : 1.0;
        size_found += std::pow(unit * static_cast<double>(found[i]), 2);
        size_given += std::pow(unit * static_cast<double>(rate[i]), 2);
        if (g.joint_count <= 6) {
          EXPECT_NEAR(found[i], rate[i], TestFixture::is_double ? 1e-8 : 2e-3);
        }
      }
      EXPECT_LE(size_found, size_given * (1 + 1e-3));
    }
  }
}

// On the way into a singularity, and exactly on it: within the limits, and ok only if the product of the factors agrees.
TYPED_TEST(Forms, VelocitiesStayBoundedIntoASingularity) {
  using Real = TypeParam;
  Random random(95);
  for (int n = 0; n < cases(50); ++n) {
    const Geometry nominal = n % 2 == 0 ? ur5() : wrist_arm();
    const Geometry g = n % 3 == 0 ? nominal : with_errors(nominal, random, 1e-3, 0.1 * deg);
    Arm<Real> arm{};
    ASSERT_EQ(make_arm(g, arm), Status::ok);
    Real q[max_joints] = {};
    this->draw(g, random, q);
    Real asked[6];
    for (Real& v : asked) v = static_cast<Real>(random.symmetric(0.2));
    JointRateLimits<Real> limit{};
    std::fill(limit.max_velocity, limit.max_velocity + max_joints, Real(1.5));
    std::fill(limit.max_acceleration, limit.max_acceleration + max_joints, Real(10));
    int short_of_it = 0;
    for (int decade = 0; decade <= 16; ++decade) {
      q[4] = decade == 16 ? Real(0) : static_cast<Real>(std::pow(10.0, -decade));
      Real found[max_joints] = {};
      const Status status = joint_velocities(arm, q, asked, limit, found);
      for (int i = 0; i < 6; ++i) EXPECT_LE(std::fabs(found[i]), limit.max_velocity[i]);
      ASSERT_TRUE(status == Status::ok || status == Status::near_singular || status == Status::step_limited);
      if (status != Status::ok) ++short_of_it;
      const Velocity reached = velocity_of(g, q, found);
      double missed = 0;
      double size = 0;
      for (int k = 0; k < 6; ++k) {
        const double asked_k = static_cast<double>(asked[k]);
        missed = std::max(missed, std::fabs(static_cast<double>(reached.along[k]) - asked_k));
        size = std::max(size, std::fabs(asked_k));
      }
      if (status == Status::ok) {
        EXPECT_LE(missed, size * (TestFixture::is_double ? 1e-7 : 1e-3));
      }
      EXPECT_LE(missed, 3 * size);
    }
    EXPECT_GT(short_of_it, 8);
  }
}

}  // namespace
