// SPDX-License-Identifier: MIT
// NaN, infinities, subnormal and huge numbers in every number that a caller passes, one at a time: bad_input with every
// output as it was, or another status with finite outputs; and never an exception that traps where a caller has enabled it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <functional>
#include <limits>
#include <vector>

#include "mdhcal/compensator.hpp"
#include "mdhcal/solutions.hpp"
#include "tests/lib/poses.hpp"
#include "tests/support/exceptions.hpp"

namespace {

using namespace mdhcal;
using namespace mdhcal::test;

struct Outcome {
  Status status;
  bool untouched;
  bool finite;
};

// Plain data that holds nothing but `Real`.
template <class Real, class T>
bool all_finite(const T& data) {
  Real values[sizeof(T) / sizeof(Real)];
  std::memcpy(values, &data, sizeof data);
  return std::all_of(std::begin(values), std::end(values), [](Real x) { return std::isfinite(x); });
}

template <class T>
bool same_bytes(const T& a, const T& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

template <class Real>
class HostileInput : public ::testing::Test {
 protected:
  struct Joints {
    Real q[max_joints];
  };
  static constexpr Real nan = std::numeric_limits<Real>::quiet_NaN();
  static constexpr Real infinity = std::numeric_limits<Real>::infinity();
  static constexpr Real tiny = std::numeric_limits<Real>::denorm_min();
  static constexpr Real huge = sizeof(Real) == sizeof(double) ? Real(1e300) : Real(1e38F);

  void SetUp() override {
    Random random(81);
    ASSERT_EQ(make_calibrated_arm(ur5(), with_errors(ur5(), random, 1e-3, 0.1 * deg), model), Status::ok);
    options = default_solution_options(model.corrected);
    tick_options = default_tick_options(model.corrected);
    tick_options.posture.gain = Real(0.1);
    ASSERT_EQ(start_at_rest(model, Model::nominal, state), Status::ok);
    ASSERT_EQ(start_ramp(state, model, Model::corrected, 10), Status::ok);
    for (int n = 0; n < 5; ++n) ASSERT_EQ(advance_ramp(state), Status::ok);
    for (std::size_t i = 0; i < 6; ++i) {
      joints.q[i] = Real(0.1) + Real(0.2) * static_cast<Real>(i);
      nominal.q[i] = joints.q[i];
      limits.max_velocity[i] = Real(1);
      limits.max_acceleration[i] = Real(10);
      velocity[i] = Real(0.1);
    }
    ASSERT_EQ(forward(model.corrected, joints.q, target), Status::ok);
  }

  std::vector<Real*> of(Real* first, std::size_t count) {
    std::vector<Real*> slots;
    for (std::size_t i = 0; i < count; ++i) slots.push_back(first + i);
    return slots;
  }
  std::vector<Real*> of_target() {
    std::vector<Real*> slots = of(target.quaternion, 4);
    for (Real& p : target.position_m) slots.push_back(&p);
    return slots;
  }
  static std::vector<Real*> of(GoalOptions<Real>& goal) {
    return {&goal.position_tolerance_m, &goal.rotation_tolerance_rad, &goal.position_weight, &goal.rotation_weight};
  }
  static std::vector<Real*> of(TickOptions<Real>& t) {
    std::vector<Real*> slots = of(t.goal);
    slots.push_back(&t.posture.gain);
    for (std::size_t i = 0; i < 6; ++i) {
      slots.push_back(&t.limits.max_step[i]);
      slots.push_back(&t.posture.q[i]);
    }
    return slots;
  }

  void attack(const char* name, const std::vector<Real*>& slots, const std::function<Outcome()>& call) {
    const Outcome good = call();
    EXPECT_NE(good.status, Status::bad_input) << name;
    EXPECT_FALSE(good.untouched) << name << ": the test would prove nothing";
    for (std::size_t slot = 0; slot < slots.size(); slot += emulated ? 4 : 1) {
      const Real kept = *slots[slot];
      for (const Real value : {nan, -nan, infinity, -infinity, huge, -huge, std::numeric_limits<Real>::max()}) {
        *slots[slot] = value;
        clear_exceptions();
        const Outcome outcome = call();
        EXPECT_FALSE(exceptions_raised())
            << name << " slot " << slot << " value " << value;
        EXPECT_EQ(outcome.status, Status::bad_input) << name << " slot " << slot << " value " << value;
        EXPECT_TRUE(outcome.untouched) << name << " slot " << slot << " value " << value;
      }
      for (const Real value : {tiny, -tiny, Real(0), -Real(0), std::numeric_limits<Real>::min(), Real(1e-30F)}) {
        *slots[slot] = value;
        clear_exceptions();
        const Outcome outcome = call();
        EXPECT_FALSE(exceptions_raised())
            << name << " slot " << slot << " value " << value;
        EXPECT_TRUE(outcome.status == Status::bad_input ? outcome.untouched : outcome.finite)
            << name << " slot " << slot << " value " << value;
      }
      *slots[slot] = kept;
    }
  }

  // A call that moves `joints` in place.
  std::function<Outcome()> in_place(const std::function<Status(Real*)>& call) {
    return [this, call] {
      Joints q = joints;
      const Status status = call(q.q);
      return Outcome{status, same_bytes(q, joints), all_finite<Real>(q)};
    };
  }

  // A call that fills a T.
  template <class T>
  std::function<Outcome()> filling(const std::function<Status(T&)>& call) {
    return [call] {
      T before;
      std::memset(&before, 0x3B, sizeof before);
      T out = before;
      const Status status = call(out);
      return Outcome{status, same_bytes(out, before), all_finite<Real>(out)};
    };
  }

  CalibratedArm<Real> model{};
  SolutionOptions<Real> options{};
  TickOptions<Real> tick_options{};
  Compensator<Real> state{};
  Pose<Real> target{};
  Joints joints{};
  Joints nominal{};
  JointRateLimits<Real> limits{};
  Real velocity[6] = {};
};
using Reals = ::testing::Types<double, float>;
TYPED_TEST_SUITE(HostileInput, Reals, );

TYPED_TEST(HostileInput, OfForward) {
  using Real = TypeParam;
  const Arm<Real>& arm = this->model.corrected;
  Real* q = this->joints.q;
  struct Frames {
    Frame<Real> frame[max_joints + 2];
  };
  this->attack("forward", this->of(q, 6),
               this->template filling<Pose<Real>>([&](Pose<Real>& pose) { return forward(arm, q, pose); }));
  Jacobian<Real> jacobian{};
  this->attack("forward with Jacobian, pose", this->of(q, 6), this->template filling<Pose<Real>>([&](Pose<Real>& pose) {
    return forward(arm, q, pose, jacobian);
  }));
  Pose<Real> pose{};
  this->attack("forward with Jacobian", this->of(q, 6), this->template filling<Jacobian<Real>>([&](Jacobian<Real>& j) {
    return forward(arm, q, pose, j);
  }));
  this->attack("link_frames", this->of(q, 6), this->template filling<Frames>([&](Frames& frames) {
    return link_frames(arm, q, frames.frame);
  }));
}

TYPED_TEST(HostileInput, OfTheSolver) {
  using Real = TypeParam;
  const Arm<Real>& arm = this->model.corrected;
  Real* posture = this->nominal.q;
  Solutions<Real> before;
  std::memset(&before, 0x3B, sizeof before);
  const auto find = [&] {
    Solutions<Real> found = before;
    const Status status = find_solutions(arm, this->options, this->target, posture, found);
    bool finite = true;
    for (int k = 0; status != Status::bad_input && k < found.count; ++k) {
      for (int j = 0; j < 6; ++j) finite = finite && std::isfinite(found.q[k][j]);
      finite = finite && std::isfinite(found.distance[k]);
    }
    return Outcome{status, same_bytes(found, before), finite};
  };
  this->attack("find_solutions, posture", this->of(posture, 6), find);
  this->attack("find_solutions, target", this->of_target(), find);
  this->attack("find_solutions, options", this->of(this->options.goal), find);
  for (const std::int32_t restarts : {std::int32_t{-1}, max_restarts + 1, std::numeric_limits<std::int32_t>::max()}) {
    this->options.restarts = restarts;
    EXPECT_TRUE(find().status == Status::bad_input && find().untouched);
  }
  this->options.restarts = 0;
  for (const std::int32_t task : {std::int32_t{-1}, std::int32_t{4}, std::numeric_limits<std::int32_t>::max()}) {
    this->options.goal.task = static_cast<Task>(task);
    EXPECT_TRUE(find().status == Status::bad_input && find().untouched);
  }
  this->options.goal.task = Task::pose;
  // One restart, since a tolerance that nothing meets would use all of them; from elsewhere, or the start is the answer.
  this->options.restarts = 1;
  this->joints.q[1] += Real(0.5);
  const auto start = this->in_place([&](Real* q) { return cold_start(arm, this->options, this->target, q); });
  this->attack("cold_start, joints", this->of(this->joints.q, 6), start);
  this->attack("cold_start, target", this->of_target(), start);
  this->attack("cold_start, options", this->of(this->options.goal), start);
  // Rotations that are none.
  for (const Real scale : {Real(0), Real(0.5), Real(0.999), Real(1.001), Real(2)}) {
    Pose<Real> wrong = this->target;
    for (Real& c : wrong.quaternion) c *= scale;
    Real q[6];
    std::copy(this->joints.q, this->joints.q + 6, q);
    EXPECT_EQ(cold_start(arm, this->options, wrong, q), Status::bad_input) << scale;
    EXPECT_TRUE(std::equal(q, q + 6, this->joints.q));
  }
}

TYPED_TEST(HostileInput, OfTheCompensator) {
  using Real = TypeParam;
  const TickOptions<Real>& how = this->tick_options;
  this->joints.q[1] += Real(0.01);
  const auto first = this->in_place([&](Real* q) {
    return pose_to_joints(this->state, how, this->target, q);
  });
  const auto second = this->in_place([&](Real* q) {
    return joints_to_joints(this->state, how, this->nominal.q, q);
  });
  const auto third = this->in_place([&](Real* q) {
    Pose<Real> command{};
    return pose_to_pose(this->state, how, this->target, q, command);
  });
  for (const auto& form : {first, second, third}) {
    this->attack("joints", this->of(this->joints.q, 6), form);
    this->attack("options", this->of(this->tick_options), form);
  }
  this->attack("first form, target", this->of_target(), first);
  this->attack("second form, nominal joints", this->of(this->nominal.q, 6), second);
  this->attack("third form, target", this->of_target(), third);
  this->attack("third form, command", this->of_target(), this->template filling<Pose<Real>>([&](Pose<Real>& command) {
    Real q[max_joints];
    std::copy(this->joints.q, this->joints.q + max_joints, q);
    return pose_to_pose(this->state, how, this->target, q, command);
  }));
}

TYPED_TEST(HostileInput, OfTheFrames) {
  using Real = TypeParam;
  Frames<Real> frames{this->target, this->target};
  Compensator<Real> out;
  const auto start = [&] {
    out = this->state;
    const Status status = start_frame_ramp(out, frames, 7);
    const bool untouched = same_bytes(out, this->state);
    bool finite = true;
    Real q[6];
    std::copy(this->joints.q, this->joints.q + 6, q);
    if (status == Status::ok) {
      EXPECT_EQ(advance_ramp(out), Status::ok);
      finite = all_finite<Real>(out.frames) && all_finite<Real>(out.arm.last_T_flange);
    }
    return Outcome{status, untouched, finite};
  };
  for (Pose<Real>* pose : {&frames.base_T_user, &frames.flange_T_tool}) {
    std::vector<Real*> slots = this->of(pose->quaternion, 4);
    for (Real& p : pose->position_m) slots.push_back(&p);
    this->attack("frames", slots, start);
    this->attack("multiply", slots, this->template filling<Pose<Real>>([&](Pose<Real>& product) {
      return multiply(*pose, this->target, product);
    }));
    this->attack("invert", slots, this->template filling<Pose<Real>>([&](Pose<Real>& back) { return invert(*pose, back); }));
  }
}

TYPED_TEST(HostileInput, OfTheVelocities) {
  using Real = TypeParam;
  struct Velocities {
    Real joint[6];
  };
  const auto call = this->template filling<Velocities>([&](Velocities& out) {
    return joint_velocities(this->model.corrected, this->joints.q, this->velocity, this->limits, out.joint);
  });
  const auto with_ramp = this->template filling<Velocities>([&](Velocities& out) {
    return joint_velocities(this->state, this->joints.q, this->velocity, Real(0.001), this->limits, out.joint);
  });
  const auto accelerations = this->template filling<Velocities>([&](Velocities& out) {
    return joint_accelerations(this->model.corrected, this->joints.q, this->joints.q, this->velocity, this->limits, out.joint);
  });
  for (const auto& form : {call, with_ramp, accelerations}) {
    this->attack("joints", this->of(this->joints.q, 6), form);
    this->attack("flange velocity", this->of(this->velocity, 6), form);
    this->attack("acceleration limits", this->of(this->limits.max_acceleration, 6), form);
  }
  this->attack("velocity limits", this->of(this->limits.max_velocity, 6), call);
  this->attack("velocity limits", this->of(this->limits.max_velocity, 6), with_ramp);
}

// Geometries are in double for both precisions.
TYPED_TEST(HostileInput, OfTheGeometry) {
  using Real = TypeParam;
  Random random(82);
  Geometry g = with_errors(ur5(), random, 1e-3, 0.1 * deg);
  g.joint[2].coupling[1] = 0.5;
  for (Joint& joint : g.joint) {
    joint.has_min = joint.has_max = 1;
    joint.min = -3.0;
    joint.max = 3.0;
  }
  g.joint[6] = g.joint[7] = Joint{};
  Arm<Real> before;
  std::memset(&before, 0x3B, sizeof before);
  CalibratedArm<Real> model_before;
  std::memset(static_cast<void*>(&model_before), 0x3B, sizeof model_before);
  Arm<Real> good = before;
  ASSERT_EQ(make_arm(g, good), Status::ok);
  const auto expect_refused = [&](const char* what) {
    Arm<Real> arm = before;
    CalibratedArm<Real> made;
    std::memcpy(static_cast<void*>(&made), &model_before, sizeof made);  // its pointer with it
    EXPECT_EQ(check_geometry(g), Status::bad_input) << what;
    EXPECT_EQ(make_arm(g, arm), Status::bad_input) << what;
    EXPECT_EQ(make_calibrated_arm(g, g, made), Status::bad_input) << what;
    EXPECT_EQ(make_calibrated_arm(ur5(), g, made), Status::bad_input) << what;
    EXPECT_TRUE(same_bytes(arm, before) && same_bytes(made, model_before)) << what;
  };
  std::vector<double*> slots;
  for (int i = 0; i < 6; ++i) {
    Link& link = g.link[i];
    slots.insert(slots.end(), {&link.alpha_rad, &link.a_m, &link.theta_rad, &link.d_m, &link.beta_rad});
    slots.insert(slots.end(), {&g.joint[i].min, &g.joint[i].max});
    for (double& ratio : g.joint[i].coupling) slots.push_back(&ratio);
  }
  for (double& c : g.last_T_flange.quaternion) slots.push_back(&c);
  for (double& p : g.last_T_flange.position_m) slots.push_back(&p);
  for (double* slot : slots) {
    const double kept = *slot;
    for (const double value : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                               -std::numeric_limits<double>::infinity(), 1e300, -1e300}) {
      *slot = value;
      expect_refused("a number");
    }
    *slot = std::numeric_limits<double>::denorm_min();
    Arm<Real> arm = before;
    if (make_arm(g, arm) == Status::ok) {
      Pose<Real> pose{};
      ASSERT_EQ(forward(arm, this->joints.q, pose), Status::ok);
      EXPECT_TRUE(all_finite<Real>(pose));
    }
    *slot = kept;
  }
  const auto refuse = [&](std::int32_t& field, std::initializer_list<std::int32_t> values, const char* what) {
    const std::int32_t kept = field;
    for (const std::int32_t value : values) {
      field = value;
      expect_refused(what);
    }
    field = kept;
  };
  constexpr std::int32_t most = std::numeric_limits<std::int32_t>::max();
  refuse(g.joint_count, {0, -1, 9, most, -most - 1}, "joint_count");
  refuse(g.joint[1].sign, {0, 2, -2, most}, "sign");
  refuse(g.joint[1].has_min, {-1, 2, most}, "has_min");
  refuse(g.joint[1].has_max, {-1, 2, most}, "has_max");
  g.joint[1].kind = static_cast<JointKind>(2);
  expect_refused("kind");
}

}  // namespace
