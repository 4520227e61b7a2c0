// SPDX-License-Identifier: MIT
// The compensator on arms with every term of the transmission: its three forms, its ramps, payloads.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "mdhcal/compensator.hpp"
#include "tests/lib/arms.hpp"
#include "tests/lib/transmissions.hpp"

namespace {

using namespace mdhcal;
using namespace mdhcal::test;

// Six joints of one nominal geometry, two calibrations of it with terms of their own.
template <class Real>
struct Job {
  Geometry nominal;
  CalibratedArm<Real> arm[2];
  Compensator<Real> loop;
};

template <class Real>
std::unique_ptr<Job<Real>> some_job(Random& random, int kind) {
  auto job = std::make_unique<Job<Real>>();
  job->nominal = kind % 2 == 0 ? ur5() : wrist_arm();
  if (kind % 3 == 1) job->nominal.joint[2].coupling[1] = 0.5;
  for (CalibratedArm<Real>& arm : job->arm) {
    const Geometry corrected = with_errors(job->nominal, random, 1e-3, 0.1 * deg);
    EXPECT_EQ(make_calibrated_arm(job->nominal, corrected, some_transmission(random, corrected), arm), Status::ok);
  }
  EXPECT_EQ(start_at_rest(job->arm[0], Model::corrected, job->loop), Status::ok);
  return job;
}

double distance(const Pose<double>& a, const Pose<double>& b) {
  double square = 0;
  for (int k = 0; k < 3; ++k) square += (a.position_m[k] - b.position_m[k]) * (a.position_m[k] - b.position_m[k]);
  return std::sqrt(square);
}

TEST(LoopWithTerms, ItsThreeFormsMakeTheArmReachWhatIsMeant) {
  Random random(1820);
  int met = 0;
  for (int n = 0; n < cases(200); ++n) {
    const auto job = some_job<double>(random, n);
    double q[6], nominal_q[6];
    for (int i = 0; i < 6; ++i) nominal_q[i] = q[i] = random.uniform(0.3, 2.0);
    const TickOptions<double> options = default_tick_options(job->arm[0].corrected);
    Pose<double> meant{}, reached{};
    ASSERT_EQ(forward(job->arm[0].nominal, nominal_q, meant), Status::ok);
    if (joints_to_joints(job->loop, options, nominal_q, q) != Status::ok) continue;
    ++met;
    ASSERT_EQ(forward(job->arm[0].corrected, q, reached), Status::ok);
    ASSERT_LT(distance(meant, reached), 1.01e-10) << n;
    double by_pose[6];
    for (int i = 0; i < 6; ++i) by_pose[i] = nominal_q[i];
    ASSERT_EQ(pose_to_joints(job->loop, options, meant, by_pose), Status::ok);
    for (int i = 0; i < 6; ++i) ASSERT_NEAR(by_pose[i], q[i], 1e-7) << n;
    Pose<double> command{}, of_command{};
    ASSERT_EQ(pose_to_pose(job->loop, options, meant, by_pose, command), Status::ok);
    ASSERT_EQ(forward(job->arm[0].nominal, by_pose, of_command), Status::ok);
    ASSERT_LT(distance(command, of_command), 1e-12);
  }
  EXPECT_GT(met, cases(200) * 9 / 10);
}

// At joints that stand still the tool moves as ramp_motion() says, without a jump of its velocity: into the terms, out of them,
// from one calibration's to the other's, turned back in the middle, and to another payload.
TEST(LoopWithTerms, RampsWithoutAJumpOfVelocity) {
  Random random(1821);
  for (int n = 0; n < cases(40); ++n) {
    const auto job = some_job<double>(random, n);
    double q[6];
    for (double& x : q) x = random.symmetric(pi);
    ASSERT_EQ(start_at_rest(job->arm[0], Model::nominal, job->loop), Status::ok);
    Pose<double> pose{};
    double last[3] = {}, velocity[3] = {}, told_before[3] = {};
    ASSERT_EQ(forward(job->loop.arm, q, pose), Status::ok);
    for (int k = 0; k < 3; ++k) last[k] = pose.position_m[k];
    double fastest = 0, jump = 0, apart = 0;
    for (int tick = 0; tick < 2400; ++tick) {
      if (tick == 0) { ASSERT_EQ(start_ramp(job->loop, job->arm[0], Model::corrected, 400), Status::ok); }
      if (tick == 150) { ASSERT_EQ(start_ramp(job->loop, job->arm[0], Model::nominal, 400), Status::ok); }
      if (tick == 300) { ASSERT_EQ(start_ramp(job->loop, job->arm[0], Model::corrected, 400), Status::ok); }
      if (tick == 800) { ASSERT_EQ(start_ramp(job->loop, job->arm[1], Model::corrected, 400), Status::ok); }
      if (tick == 1300) { ASSERT_EQ(start_payload_ramp(job->loop, 8.0, 400), Status::ok); }
      if (tick == 1500) { ASSERT_EQ(start_ramp(job->loop, job->arm[0], Model::corrected, 400), Status::ok); }
      if (tick == 1600) { ASSERT_EQ(start_ramp(job->loop, job->arm[1], Model::nominal, 400), Status::ok); }
      ASSERT_EQ(advance_ramp(job->loop), Status::ok);
      double motion[6];
      ASSERT_EQ(ramp_motion(job->loop, q, motion), Status::ok);
      ASSERT_EQ(forward(job->loop.arm, q, pose), Status::ok);
      double change = 0, speed = 0, difference = 0;
      for (int k = 0; k < 3; ++k) {
        const double now = pose.position_m[k] - last[k];
        change += (now - velocity[k]) * (now - velocity[k]);
        speed += now * now;
        // Between two ticks the mean of what is told at both, but where a ramp begins anew in between.
        const double told = 0.5 * (motion[k] + told_before[k]) - now;
        difference += told * told;
        told_before[k] = motion[k];
        velocity[k] = now;
        last[k] = pose.position_m[k];
      }
      fastest = std::max(fastest, std::sqrt(speed));
      jump = std::max(jump, std::sqrt(change));
      apart = std::max(apart, std::sqrt(difference));
    }
    // A quintic of 200 ticks changes its velocity by at most 10 / 200^2 of the way a tick; its fastest is 1.9 / 200 of it.
    ASSERT_LT(jump, 0.06 * fastest) << n;
    ASSERT_LT(apart, 0.01 * fastest) << n;
    ASSERT_EQ(ramp_ticks_left(job->loop), 0U);
    Pose<double> nominal{};
    ASSERT_EQ(forward(job->arm[1].nominal, q, nominal), Status::ok);
    ASSERT_EQ(distance(pose, nominal), 0) << "nominal stays nominal";
  }
}

// Along joints with the velocities and accelerations found, the flange moves as asked for, by the series and the torque.
TEST(LoopWithTerms, VelocitiesAndAccelerationsAreThoseOfTheArm) {
  Random random(1824);
  int met = 0;
  for (int n = 0; n < cases(300); ++n) {
    const Geometry g = some_arm(random, n % 3);
    const Transmission t = some_transmission(random, g);
    const auto arm = std::make_unique<CalibratedArm<double>>();
    ASSERT_EQ(make_calibrated_arm(g, g, t, *arm), Status::ok);
    double q[6], twist[6], wanted[6], velocity[6], acceleration[6];
    for (int k = 0; k < 6; ++k) {
      q[k] = random.symmetric(pi);
      twist[k] = random.symmetric(0.2);
      wanted[k] = random.symmetric(0.5);
    }
    JointRateLimits<double> limits{};
    for (double& v : limits.max_velocity) v = 1e3;
    for (double& a : limits.max_acceleration) a = 1e4;
    if (joint_velocities(arm->corrected, q, twist, limits, velocity) != Status::ok) continue;
    if (joint_accelerations(arm->corrected, q, velocity, wanted, limits, acceleration) != Status::ok) continue;
    double fastest = 0;
    for (int k = 0; k < 6; ++k) fastest = std::max(fastest, std::fabs(velocity[k]));
    if (fastest > 3) continue;
    ++met;
    constexpr long double h = 1e-5L;
    tests::WideFrame at[3];
    for (int s = 0; s < 3; ++s) {
      const long double time = static_cast<long double>(s - 1) * h;
      long double there[6];
      for (int k = 0; k < 6; ++k) {
        there[k] = static_cast<long double>(q[k]) + time * static_cast<long double>(velocity[k]) +
                   time * time / 2 * static_cast<long double>(acceleration[k]);
      }
      at[s] = wide_forward_terms(g, t, static_cast<long double>(t.gravity.payload_kg), there);
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const double speed = static_cast<double>((at[2].m[k][3] - at[0].m[k][3]) / (2 * h));
      const double second = static_cast<double>((at[2].m[k][3] - 2 * at[1].m[k][3] + at[0].m[k][3]) / (h * h));
      ASSERT_NEAR(speed, twist[k], 1e-6) << n;
      ASSERT_NEAR(second, wanted[k], 1e-4 * (1 + fastest * fastest)) << n;
    }
  }
  EXPECT_GT(met, cases(300) / 2);
}

TEST(LoopWithTerms, KnowsWhichArmItRefersTo) {
  Random random(1822);
  const auto job = some_job<double>(random, 0);
  Compensator<double>& loop = job->loop;
  EXPECT_TRUE(refers_to(loop, job->arm[0]));
  EXPECT_FALSE(refers_to(loop, job->arm[1]));
  ASSERT_EQ(start_ramp(loop, job->arm[1], Model::corrected, 10), Status::ok);
  for (int tick = 0; tick < 10; ++tick) {
    EXPECT_TRUE(refers_to(loop, job->arm[1]));
    if (tick < 4) { EXPECT_TRUE(refers_to(loop, job->arm[0])) << tick; }
    ASSERT_EQ(advance_ramp(loop), Status::ok);
  }
  EXPECT_FALSE(refers_to(loop, job->arm[0]));
  // A copy has its own table.
  const CalibratedArm<double> copy = job->arm[1];
  EXPECT_EQ(copy.corrected.terms.functions, &copy.functions);
}

TEST(LoopWithTerms, RefusesPayloadsThatItCannotAnswerFor) {
  Random random(1823);
  const auto job = some_job<double>(random, 0);
  for (const double kg : {-1.0, 1e5, 5000.0, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_EQ(start_payload_ramp(job->loop, kg, 10), Status::bad_input) << kg;
    EXPECT_EQ(set_payload(job->arm[0].corrected, kg), Status::bad_input) << kg;
  }
  EXPECT_EQ(set_payload(job->arm[0].nominal, 1.0), Status::bad_input) << "it does not know what a payload does";
  EXPECT_EQ(set_payload(job->arm[0].nominal, 0.0), Status::ok);
}

TEST(LoopWithTerms, TellsOfReadingsThatWereNotSeen) {
  Transmission t{};
  t.function[2].order_count = 1;
  t.function[2].cosine_rad[0] = 1e-4F;
  t.function[2].seen_min_rad = -1;
  t.function[2].seen_max_rad = 1;
  CalibratedArm<double> arm{};
  ASSERT_EQ(make_calibrated_arm(ur5(), ur5(), t, arm), Status::ok);
  double q[6] = {0.5, 0.6, 0.9, 0.5, 0.7, 0.2};
  Pose<double> pose{};
  TickReport<double> report{};
  for (const double reading : {0.9, 1.3}) {
    q[2] = reading;
    ASSERT_EQ(forward(arm.corrected, q, pose), Status::ok);
    ASSERT_EQ(tick(arm.corrected, default_tick_options(arm.corrected), pose, q, &report), Status::ok);
    EXPECT_EQ(report.unseen_mask, reading > 1 ? 4U : 0U);
    ASSERT_EQ(tick(arm.nominal, default_tick_options(arm.nominal), pose, q, &report), Status::ok);
    EXPECT_EQ(report.unseen_mask, 0U);
  }
}

}  // namespace
