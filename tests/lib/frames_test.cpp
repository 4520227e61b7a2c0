// SPDX-License-Identifier: MIT
// The loop with a user frame and a tool: the three forms and velocities against products of matrices in long double.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "mdhcal/compensator.hpp"
#include "tests/lib/factors.hpp"
#include "tests/lib/poses.hpp"

namespace {

using namespace mdhcal;
using namespace mdhcal::test;

template <class Real>
Pose<Real> a_pose(Random& random, double length_m) {
  Pose<Real> pose{};
  double c[4], square = 0;
  for (double& x : c) {
    x = random.symmetric(1);
    square += x * x;
  }
  const double norm = std::sqrt(square) * (c[0] < 0 ? -1 : 1);
  for (int k = 0; k < 4; ++k) pose.quaternion[k] = static_cast<Real>(c[k] / norm);
  for (Real& p : pose.position_m) p = static_cast<Real>(random.symmetric(length_m));
  return pose;
}

template <class Real>
Matrix matrix_of(const Pose<Real>& pose) {
  const long double w = pose.quaternion[0], x = pose.quaternion[1], y = pose.quaternion[2], z = pose.quaternion[3];
  const long double n = 2 / (w * w + x * x + y * y + z * z);
  return {{{1 - n * (y * y + z * z), n * (x * y - w * z), n * (x * z + w * y), pose.position_m[0]},
           {n * (x * y + w * z), 1 - n * (x * x + z * z), n * (y * z - w * x), pose.position_m[1]},
           {n * (x * z - w * y), n * (y * z + w * x), 1 - n * (x * x + y * y), pose.position_m[2]},
           {0, 0, 0, 1}}};
}

template <class Real>
class LoopInFrames : public ::testing::Test {
 protected:
  static constexpr double tolerance = sizeof(Real) == sizeof(double) ? 2e-10 : 1.5e-5;

  // A six-joint arm at rest on its corrected model, in frames of its own.
  void make(std::uint64_t seed) {
    Random random(seed);
    nominal_ = seed % 2 == 0 ? ur5() : wrist_arm();
    corrected_ = with_errors(nominal_, random, 1e-3, 0.1 * deg);
    CalibratedArm<Real> arm;
    ASSERT_EQ(make_calibrated_arm(nominal_, corrected_, arm), Status::ok);
    ASSERT_EQ(start_at_rest(arm, Model::corrected, loop_), Status::ok);
    frames_ = {a_pose<Real>(random, 1.0), a_pose<Real>(random, 0.2)};
    ASSERT_EQ(start_frame_ramp(loop_, frames_, 0), Status::ok);
    options_ = default_tick_options(arm.corrected);
    const double joints[6] = {0.4, -0.9, 1.1, -0.7, 0.8, -0.5};
    for (int j = 0; j < 6; ++j) {
      meant_[j] = static_cast<Real>(joints[j] + random.symmetric(0.2));
      near_[j] = meant_[j] + static_cast<Real>(random.symmetric(0.01));
    }
  }

  // user_T_tool of joints: user_T_base base_T_flange flange_T_tool.
  Matrix truth(const Geometry& g, const Real* q) const {
    const Matrix tool = product(product_of_factors(g, q), matrix_of(frames_.flange_T_tool));
    Matrix user = matrix_of(frames_.base_T_user), back{};
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        back.m[i][j] = user.m[j][i];
        back.m[i][3] -= user.m[j][i] * user.m[j][3];
      }
    }
    back.m[3][3] = 1;
    return product(back, tool);
  }

  // The target that `meant_` takes on the corrected arm, as the library would be given it.
  Pose<Real> target() const {
    Pose<Real> flange, tool, user_T_base, pose;
    Arm<Real> arm;
    EXPECT_EQ(make_arm(corrected_, arm), Status::ok);
    EXPECT_EQ(forward(arm, meant_, flange), Status::ok);
    EXPECT_EQ(multiply(flange, frames_.flange_T_tool, tool), Status::ok);
    EXPECT_EQ(invert(frames_.base_T_user, user_T_base), Status::ok);
    EXPECT_EQ(multiply(user_T_base, tool, pose), Status::ok);
    return pose;
  }

  void expect_at(const Matrix& truth, const Pose<Real>& pose) const {
    const Distance away = distance(truth, pose);
    EXPECT_LE(away.position_m, tolerance);
    EXPECT_LE(away.rotation_rad, tolerance);
  }

  Geometry nominal_, corrected_;
  Compensator<Real> loop_;
  Frames<Real> frames_;
  TickOptions<Real> options_;
  Real meant_[6], near_[6];
};
using Reals = ::testing::Types<double, float>;
TYPED_TEST_SUITE(LoopInFrames, Reals, );

TYPED_TEST(LoopInFrames, PosesAreOfTheToolInTheUserFrame) {
  using Real = TypeParam;
  for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(cases(100)); ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    this->make(seed);
    const Pose<Real> target = this->target();
    this->expect_at(this->truth(this->corrected_, this->meant_), target);
    Real q[6];
    std::copy(this->near_, this->near_ + 6, q);
    ASSERT_EQ(pose_to_joints(this->loop_, this->options_, target, q), Status::ok);
    this->expect_at(this->truth(this->corrected_, q), target);
    // The third form: what the nominal arm has to be told is where its own tool is at these joints.
    Real again[6];
    std::copy(this->near_, this->near_ + 6, again);
    Pose<Real> command;
    ASSERT_EQ(pose_to_pose(this->loop_, this->options_, target, again, command), Status::ok);
    for (int j = 0; j < 6; ++j) EXPECT_EQ(again[j], q[j]);
    this->expect_at(this->truth(this->nominal_, again), command);
  }
}

TYPED_TEST(LoopInFrames, CorrectedJointsBringTheToolWhereTheNominalOnesMeanIt) {
  using Real = TypeParam;
  for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(cases(100)); ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    this->make(seed);
    Real q[6];
    std::copy(this->meant_, this->meant_ + 6, q);
    ASSERT_EQ(joints_to_joints(this->loop_, this->options_, this->meant_, q), Status::ok);
    const Matrix meant = this->truth(this->nominal_, this->meant_);
    const Matrix reached = this->truth(this->corrected_, q);
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 4; ++j) {
        EXPECT_NEAR(static_cast<double>(reached.m[i][j]), static_cast<double>(meant.m[i][j]), this->tolerance) << i << ' ' << j;
      }
    }
  }
}

// A velocity in the user frame's axes, of the tool's origin: against a difference of the product of matrices.
TYPED_TEST(LoopInFrames, VelocitiesAreOfTheToolInTheUserFrame) {
  using Real = TypeParam;
  for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(cases(50)); ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    this->make(seed);
    Random random(900 + seed);
    Real wanted[6], velocity[6];
    for (Real& w : wanted) w = static_cast<Real>(random.symmetric(0.02));
    JointRateLimits<Real> limits{};
    std::fill(limits.max_velocity, limits.max_velocity + max_joints, Real{10});
    std::fill(limits.max_acceleration, limits.max_acceleration + max_joints, Real{1e6F});
    ASSERT_EQ(joint_velocities(this->loop_, this->meant_, wanted, Real(1e-3F), limits, velocity), Status::ok);
    // By a thousandth of a second on both sides: the third order is left, 1e-9 of velocities of 0.1.
    double before[6], after[6];
    for (int j = 0; j < 6; ++j) {
      before[j] = static_cast<double>(this->meant_[j]) - 1e-3 * static_cast<double>(velocity[j]);
      after[j] = static_cast<double>(this->meant_[j]) + 1e-3 * static_cast<double>(velocity[j]);
    }
    const auto truth = [&](const double* q) {
      Matrix m = product(product_of_factors(this->corrected_, q), matrix_of(this->frames_.flange_T_tool));
      const Matrix user = matrix_of(this->frames_.base_T_user);
      Matrix turned{};  // into the user frame's axes; its origin adds the same to both
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 4; ++j) {
          for (int k = 0; k < 3; ++k) turned.m[i][j] += user.m[k][i] * m.m[k][j];
        }
      }
      return turned;
    };
    const Matrix a = truth(before), b = truth(after), here = truth(std::vector<double>(this->meant_, this->meant_ + 6).data());
    const double bound = sizeof(Real) == sizeof(double) ? 1e-7 : 2e-5;
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(static_cast<double>((b.m[k][3] - a.m[k][3]) / 2e-3L), static_cast<double>(wanted[k]), bound) << k;
      const int x = (k + 1) % 3, y = (k + 2) % 3;
      long double rate = 0;  // the skew part of dR/dt R^T
      for (int j = 0; j < 3; ++j) {
        rate += ((b.m[y][j] - a.m[y][j]) * here.m[x][j] - (b.m[x][j] - a.m[x][j]) * here.m[y][j]) / 4e-3L;
      }
      EXPECT_NEAR(static_cast<double>(rate), static_cast<double>(wanted[3 + k]), bound) << 3 + k;
    }
  }
}

}  // namespace
