// SPDX-License-Identifier: MIT
// Properties of the loop over random arms of seven kinds, fixed seeds: ramps, the second form, velocities, accelerations.
// A failure names its kind and seed.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <vector>

#include "mdhcal/mdhcal.hpp"
#include "tests/lib/factors.hpp"
#include "tests/lib/poses.hpp"

namespace {

using namespace mdhcal;
using namespace mdhcal::test;

Geometry scara() {
  Geometry g = from_table({{0, 0, 0, 0.3}, {0, 0.325, 0, 0.02}, {0, 0.275, 0, 0}, {180, 0, 0, 0}});
  g.joint[2].kind = JointKind::prismatic;
  return g;
}

Geometry gantry() {
  Geometry g = from_table({{0, 0, 0, 0}, {-90, 0, -90, 0}, {-90, 0, -90, 0}, {0, 0, 0, 0.2}, {90, 0, 0, 0}, {-90, 0, 0, 0.1}});
  for (int i = 0; i < 3; ++i) g.joint[i].kind = JointKind::prismatic;
  return g;
}

constexpr int kind_count = 7;
Geometry arm_of(int kind, Random& random) {
  switch (kind) {
    case 0: return with_errors(ur5(), random, 0.05, 2 * deg);
    case 1: return with_errors(wrist_arm(), random, 0.05, 2 * deg);
    case 2: return random_arm(random);
    case 3: return with_errors(seven_joint_arm(), random, 0.02, 2 * deg);
    case 4: return with_errors(five_joint_arm(), random, 0.02, 2 * deg);
    case 5: return scara();
    default: return gantry();
  }
}

Task task_of(int kind) { return kind == 4 || kind == 5 ? Task::position : Task::pose; }

// The arm with calibration errors, the flange and limits moved as well.
Geometry recalibrated(const Geometry& nominal, Random& random) {
  Geometry g = with_errors(nominal, random, 1e-3, 0.1 * deg);
  const double half = random.symmetric(0.2);
  g.last_T_flange.quaternion[0] = std::cos(half);
  g.last_T_flange.quaternion[1] = std::sin(half);
  for (double& p : g.last_T_flange.position_m) p = random.symmetric(0.05);
  return g;
}

template <class Real>
void draw(const Geometry& g, Random& random, Real* q) {
  for (int i = 0; i < g.joint_count; ++i) {
    q[i] = static_cast<Real>((random.symmetric(1) < 0 ? -1 : 1) * random.uniform(0.3, 1.2));
  }
}

Pose<double> random_pose(Random& random, double angle_rad) {
  double axis[3], square = 0;
  for (double& a : axis) {
    a = random.symmetric(1);
    square += a * a;
  }
  const double half = 0.5 * random.symmetric(angle_rad);
  Pose<double> pose{{std::cos(half), 0, 0, 0}, {}};
  for (int k = 0; k < 3; ++k) {
    pose.quaternion[1 + k] = std::sin(half) * axis[k] / std::sqrt(square);
    pose.position_m[k] = random.symmetric(0.2);
  }
  return pose;
}

template <class Real>
Pose<Real> as(const Pose<double>& pose) {
  Pose<Real> out{};
  for (int k = 0; k < 4; ++k) out.quaternion[k] = static_cast<Real>(pose.quaternion[k]);
  for (int k = 0; k < 3; ++k) out.position_m[k] = static_cast<Real>(pose.position_m[k]);
  return out;
}

template <class Real>
class LoopProperty : public ::testing::Test {};
using Reals = ::testing::Types<double, float>;
TYPED_TEST_SUITE(LoopProperty, Reals, );

// Ramps between blobs, models and frames, begun anew at any tick: the tool's second difference at fixed joints stays of the
// order of the way over the square of the shortest duration, a jump of velocity would be that over the duration; each
// ends after the ticks that it was given, on the very numbers of its goal.
TYPED_TEST(LoopProperty, RampsAreSmoothWhereverTheyAreBegun) {
  using Real = TypeParam;
  constexpr std::uint32_t shortest = 200;
  for (int kind = 0; kind < kind_count; ++kind) {
    for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(cases(5)); ++seed) {
      SCOPED_TRACE(testing::Message() << "kind " << kind << " seed " << seed);
      Random random(1000 * seed + static_cast<std::uint64_t>(kind));
      const Geometry nominal = arm_of(kind, random);
      CalibratedArm<Real> blob[2];
      for (CalibratedArm<Real>& b : blob) {
        ASSERT_EQ(make_calibrated_arm(nominal, recalibrated(nominal, random), b), Status::ok);
      }
      Real q[max_joints] = {};
      draw(nominal, random, q);
      Compensator<Real> loop{};
      ASSERT_EQ(start_at_rest(blob[0], Model::nominal, loop), Status::ok);
      std::vector<Pose<Real>> path;
      for (int leg = 0; leg < 8; ++leg) {
        const std::uint32_t ticks = shortest + static_cast<std::uint32_t>(random.uniform(0, 200));
        if (leg % 3 == 2) {
          const Frames<Real> frames{as<Real>(random_pose(random, 1)), as<Real>(random_pose(random, 1))};
          ASSERT_EQ(start_frame_ramp(loop, frames, ticks), Status::ok);
        } else {
          const Model model = random.symmetric(1) < 0 ? Model::nominal : Model::corrected;
          ASSERT_EQ(start_ramp(loop, blob[leg % 2], model, ticks), Status::ok);
        }
        ASSERT_EQ(ramp_ticks_left(loop), ticks);
        const std::uint32_t part = static_cast<std::uint32_t>(random.uniform(0.05, 1.0) * ticks);
        for (std::uint32_t n = 0; n < part; ++n) {
          ASSERT_EQ(advance_ramp(loop), Status::ok);
          Pose<Real> base_T_tool{};
          ASSERT_EQ(forward(loop.arm, q, base_T_tool), Status::ok);
          path.push_back(base_T_tool);
        }
      }
      double low[3] = {1e9, 1e9, 1e9}, high[3] = {-1e9, -1e9, -1e9};
      for (const Pose<Real>& p : path) {
        for (int k = 0; k < 3; ++k) {
          low[k] = std::min(low[k], static_cast<double>(p.position_m[k]));
          high[k] = std::max(high[k], static_cast<double>(p.position_m[k]));
        }
      }
      const double way = (high[0] - low[0]) + (high[1] - low[1]) + (high[2] - low[2]);
      const double bound = 30 * way / (shortest * shortest) + (sizeof(Real) == 8 ? 1e-12 : 2e-6);
      for (std::size_t n = 2; n < path.size(); ++n) {
        for (int k = 0; k < 3; ++k) {
          const double second = static_cast<double>(path[n].position_m[k] - path[n - 1].position_m[k]) -
                                static_cast<double>(path[n - 1].position_m[k] - path[n - 2].position_m[k]);
          ASSERT_LE(std::fabs(second), bound) << "tick " << n;
        }
      }
      ASSERT_EQ(start_frame_ramp(loop, identity_frames<Real>(), 50), Status::ok);
      ASSERT_EQ(start_ramp(loop, blob[1], Model::corrected, 100), Status::ok);
      for (int n = 0; n < 100; ++n) ASSERT_EQ(advance_ramp(loop), Status::ok);
      EXPECT_EQ(ramp_ticks_left(loop), 0U);
      EXPECT_EQ(std::memcmp(&loop.arm, &blob[1].corrected, sizeof loop.arm), 0);
    }
  }
}

// Corrected joints follow the nominal ones on any path, through folds and wraps: on their turn, and no further away than the
// errors over the smallest singular value, or than their root where that is 0.
TYPED_TEST(LoopProperty, CorrectedJointsFollowTheNominalOnes) {
  using Real = TypeParam;
  constexpr double error = 4e-3;  // what 1 mm and 0.1 degrees in every parameter come to at the flange of these arms
  for (int kind = 0; kind < kind_count; ++kind) {
    for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(cases(5)); ++seed) {
      SCOPED_TRACE(testing::Message() << "kind " << kind << " seed " << seed);
      Random random(2000 * seed + static_cast<std::uint64_t>(kind));
      const Geometry nominal = arm_of(kind, random);
      CalibratedArm<Real> blob{};
      ASSERT_EQ(make_calibrated_arm(nominal, with_errors(nominal, random, 1e-3, 0.1 * deg), blob), Status::ok);
      Compensator<Real> loop{};
      ASSERT_EQ(start_at_rest(blob, Model::corrected, loop), Status::ok);
      TickOptions<Real> options = default_tick_options(blob.corrected);
      options.goal.task = task_of(kind);
      double from[max_joints], to[max_joints];
      draw(nominal, random, from);
      draw(nominal, random, to);
      Real q[max_joints] = {};
      for (int i = 0; i < nominal.joint_count; ++i) q[i] = static_cast<Real>(from[i]);
      for (int n = 0; n <= 200; ++n) {
        Real nominal_q[max_joints] = {};
        for (int i = 0; i < nominal.joint_count; ++i) {
          const bool turns = nominal.joint[i].kind == JointKind::revolute;
          // The last joint's reading wraps half way.
          const double wrap = turns && i == nominal.joint_count - 1 && n > 100 ? -2 * pi : 0;
          nominal_q[i] = static_cast<Real>(from[i] + n / 200.0 * (to[i] - from[i]) + wrap);
        }
        TickReport<Real> report{};
        const Status status = joints_to_joints(loop, options, nominal_q, q, &report);
        ASSERT_TRUE(usable(status)) << n;
        const double s = static_cast<double>(report.smallest_singular_value);
        const double allowed = std::min(3.0, 10 * error / std::max(s, 1e-9));
        for (int i = 0; i < nominal.joint_count; ++i) {
          ASSERT_LE(std::fabs(static_cast<double>(q[i] - nominal_q[i])), allowed) << "joint " << i << " step " << n << " s " << s;
        }
      }
    }
  }
}

// What a ramp does to the tool is what central differences of the ramp show, less the motion of the user frame.
TEST(LoopPropertyInDouble, RampMotionIsThatOfTheRamp) {
  for (int kind = 0; kind < kind_count; ++kind) {
    SCOPED_TRACE(testing::Message() << "kind " << kind);
    Random random(3000 + static_cast<std::uint64_t>(kind));
    const Geometry nominal = arm_of(kind, random);
    CalibratedArm<double> blob{};
    ASSERT_EQ(make_calibrated_arm(nominal, recalibrated(nominal, random), blob), Status::ok);
    double q[max_joints] = {};
    draw(nominal, random, q);
    Compensator<double> loop{};
    ASSERT_EQ(start_at_rest(blob, Model::nominal, loop), Status::ok);
    ASSERT_EQ(start_ramp(loop, blob, Model::corrected, 3000), Status::ok);
    for (int n = 0; n < 1000; ++n) ASSERT_EQ(advance_ramp(loop), Status::ok);
    ASSERT_EQ(start_frame_ramp(loop, {random_pose(random, 1), random_pose(random, 1)}, 5000), Status::ok);
    Compensator<double> at[3];
    for (int n = 0; n < 2003; ++n) {
      ASSERT_EQ(advance_ramp(loop), Status::ok);
      if (n >= 2000) at[n - 2000] = loop;
    }
    // The tool in the user frame, as seen by a target that rests in it.
    Pose<double> seen[3], base_T_tool{}, user_T_base{};
    for (int n = 0; n < 3; ++n) {
      ASSERT_EQ(forward(at[n].arm, q, base_T_tool), Status::ok);
      ASSERT_EQ(invert(at[n].frames.base_T_user, user_T_base), Status::ok);
      ASSERT_EQ(multiply(user_T_base, base_T_tool, seen[n]), Status::ok);
    }
    double motion[6];
    ASSERT_EQ(ramp_motion(at[1], q, motion), Status::ok);
    Pose<double> turned{};
    for (int half = 0; half < 2; ++half) {
      Pose<double> in_base{{1, 0, 0, 0}, {motion[3 * half], motion[3 * half + 1], motion[3 * half + 2]}};
      Pose<double> rotation = at[1].frames.base_T_user;
      for (double& p : rotation.position_m) p = 0;
      ASSERT_EQ(invert(rotation, rotation), Status::ok);
      ASSERT_EQ(multiply(rotation, in_base, turned), Status::ok);
      double expected[3];
      if (half == 0) {
        for (int k = 0; k < 3; ++k) expected[k] = 0.5 * (seen[2].position_m[k] - seen[0].position_m[k]);
      } else {
        double sign = 0;
        for (int k = 0; k < 4; ++k) sign += seen[2].quaternion[k] * seen[0].quaternion[k];
        double d[4];
        for (int k = 0; k < 4; ++k) d[k] = 0.5 * ((sign < 0 ? -1 : 1) * seen[2].quaternion[k] - seen[0].quaternion[k]);
        const double* p = seen[1].quaternion;
        expected[0] = 2 * ((d[1] * p[0] - d[0] * p[1]) + (d[3] * p[2] - d[2] * p[3]));
        expected[1] = 2 * ((d[2] * p[0] - d[0] * p[2]) + (d[1] * p[3] - d[3] * p[1]));
        expected[2] = 2 * ((d[3] * p[0] - d[0] * p[3]) + (d[2] * p[1] - d[1] * p[2]));
      }
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(turned.position_m[k], expected[k], 2e-9) << "component " << 3 * half + k;
    }
  }
}

// Joint accelerations undo the forward model's second derivative, by differences of the Jacobian.
TEST(LoopPropertyInDouble, AccelerationsAreThoseOfTheForwardModel) {
  for (int kind = 0; kind < kind_count; ++kind) {
    int damped = 0;
    for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(cases(20)); ++seed) {
      SCOPED_TRACE(testing::Message() << "kind " << kind << " seed " << seed);
      Random random(4000 * seed + static_cast<std::uint64_t>(kind));
      const Geometry g = arm_of(kind, random);
      Arm<double> arm{};
      ASSERT_EQ(make_arm(g, arm), Status::ok);
      double q[max_joints] = {}, rate[max_joints] = {}, joint[max_joints] = {}, found[max_joints] = {};
      draw(g, random, q);
      for (int i = 0; i < g.joint_count; ++i) {
        rate[i] = random.symmetric(1);
        joint[i] = random.symmetric(2);
      }
      constexpr double h = 1e-5;
      double velocity[2][6] = {}, wanted[6] = {};
      for (int side = 0; side < 2; ++side) {
        const double t = side == 0 ? -h : h;
        double there[max_joints] = {};
        for (int i = 0; i < g.joint_count; ++i) there[i] = q[i] + t * rate[i] + 0.5 * t * t * joint[i];
        Pose<double> pose{};
        Jacobian<double> jacobian{};
        ASSERT_EQ(forward(arm, there, pose, jacobian), Status::ok);
        for (int i = 0; i < g.joint_count; ++i) {
          for (int k = 0; k < 6; ++k) velocity[side][k] += jacobian.column[i][k] * (rate[i] + t * joint[i]);
        }
      }
      for (int k = 0; k < 6; ++k) wanted[k] = (velocity[1][k] - velocity[0][k]) / (2 * h);
      JointRateLimits<double> limits{};
      std::fill(limits.max_velocity, limits.max_velocity + max_joints, 1e3);
      std::fill(limits.max_acceleration, limits.max_acceleration + max_joints, 1e6);
      const Status status = joint_accelerations(arm, q, rate, wanted, limits, found);
      if (status == Status::near_singular) {
        ++damped;
        continue;
      }
      ASSERT_EQ(status, Status::ok);
      if (g.joint_count > 6) continue;  // redundant: met, as the status says, by others
      for (int i = 0; i < g.joint_count; ++i) EXPECT_NEAR(found[i], joint[i], 1e-4) << i;
    }
    EXPECT_LE(damped, 2) << "kind " << kind;
  }
}

// A straight line at 1 m/s from a straight wrist on, the orientation kept: no joint's velocity changes by more in a
// millisecond than its acceleration allows, and with ten times more ticks by ten times less, which a jump would not.
TEST(LoopPropertyInDouble, VelocitiesHaveNoJumpAtAWrist) {
  for (int kind = 0; kind < 2; ++kind) {
    const std::uint64_t seeds = emulated ? 2 : 10;
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
      SCOPED_TRACE(testing::Message() << "kind " << kind << " seed " << seed);
      Random random(5000 * seed + static_cast<std::uint64_t>(kind));
      Arm<double> arm{};
      ASSERT_EQ(make_arm(with_errors(kind == 0 ? ur5() : wrist_arm(), random, 1e-3, 0.1 * deg), arm), Status::ok);
      const double start[6] = {0.3, -0.8, 1.0, 0.5, random.symmetric(0.01), -0.3};
      double wanted[6] = {random.symmetric(1), random.symmetric(1), random.symmetric(1), 0, 0, 0};
      const double length = std::sqrt(wanted[0] * wanted[0] + wanted[1] * wanted[1] + wanted[2] * wanted[2]);
      for (double& w : wanted) w /= length;  // 1 m/s
      JointRateLimits<double> limits{};
      std::fill(limits.max_velocity, limits.max_velocity + 6, 3);
      std::fill(limits.max_acceleration, limits.max_acceleration + 6, 10);
      double largest[2] = {0, 0};
      for (int fine = 0; fine < 2; ++fine) {
        const int ticks = fine == 0 ? 120 : 1200;
        const double period = 0.12 / ticks;
        double q[6], last[6] = {};
        std::copy(start, start + 6, q);
        for (int n = 0; n < ticks; ++n) {
          double velocity[6];
          ASSERT_TRUE(usable(joint_velocities(arm, q, wanted, limits, velocity)));
          for (int i = 0; i < 6; ++i) {
            if (n > 0) largest[fine] = std::max(largest[fine], std::fabs(velocity[i] - last[i]));
            last[i] = velocity[i];
            q[i] += period * velocity[i];
          }
        }
      }
      EXPECT_LE(largest[0], 0.01);  // what the acceleration allows in a millisecond
      EXPECT_LE(largest[1], 0.2 * largest[0] + 1e-12);
    }
  }
}

// Towards a joint limit a joint slows down and never passes it; at it, it only moves inwards.
TEST(LoopPropertyInDouble, VelocitiesKeepTheJointLimits) {
  Geometry g = ur5();
  for (Joint& joint : g.joint) {
    joint.has_min = joint.has_max = 1;
    joint.min = -1.3;
    joint.max = 1.3;
  }
  g.joint[6] = g.joint[7] = Joint{};
  Arm<double> arm{};
  ASSERT_EQ(make_arm(g, arm), Status::ok);
  JointRateLimits<double> limits{};
  std::fill(limits.max_velocity, limits.max_velocity + 6, 3);
  std::fill(limits.max_acceleration, limits.max_acceleration + 6, 100);
  const std::uint64_t seeds = emulated ? 3 : 50;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    Random random(6000 + seed);
    double q[6], wanted[6];
    for (double& joint : q) joint = random.symmetric(1.2);
    for (double& w : wanted) w = random.symmetric(1);
    int limited = 0;
    for (int n = 0; n < 3000; ++n) {
      double velocity[6];
      const Status status = joint_velocities(arm, q, wanted, limits, velocity);
      ASSERT_TRUE(usable(status));
      if (status == Status::joint_limited) ++limited;
      for (int i = 0; i < 6; ++i) {
        q[i] += 0.001 * velocity[i];
        ASSERT_LE(std::fabs(q[i]), 1.3) << "seed " << seed;
      }
    }
    EXPECT_GT(limited, 0) << "seed " << seed;
  }
}

}  // namespace
