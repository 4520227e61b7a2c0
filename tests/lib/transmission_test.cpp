// SPDX-License-Identifier: MIT
// Forward kinematics, Jacobian and tick with every term of the transmission, on arms of seven kinds.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include "mdhcal/inverse.hpp"
#include "mdhcal/kinematics.hpp"
#include "tests/lib/arms.hpp"
#include "tests/lib/transmissions.hpp"

namespace {

using namespace mdhcal;
using namespace mdhcal::test;

template <class Real>
struct Made {
  Geometry geometry;
  Transmission transmission;
  JointFunctionTable table;
  Arm<Real> arm;
  Real payload_kg;
};

// An arm of a kind, with a payload other than the calibration's.
template <class Real>
void make(Random& random, int kind, Made<Real>& m) {
  m.geometry = some_arm(random, kind);
  m.transmission = some_transmission(random, m.geometry);
  make_table(m.transmission, m.table);
  ASSERT_EQ(make_arm(m.geometry, m.transmission, m.table, m.arm), Status::ok);
  m.payload_kg = static_cast<Real>(m.transmission.gravity.payload_kg + random.uniform(0, 3));
  ASSERT_EQ(set_payload(m.arm, m.payload_kg), Status::ok);
}

template <class Real>
void compare(double bound_m, double bound_rad) {
  Random random(1810);
  const auto m = std::make_unique<Made<Real>>();
  double worst_m = 0, worst_rad = 0;
  for (int kind = 0; kind < cases(210); ++kind) {
    make(random, kind, *m);
    for (int n = 0; n < 20; ++n) {
      Real q[max_joints] = {};
      long double wide_q[max_joints];
      for (int i = 0; i < m->geometry.joint_count; ++i) {
        q[i] = static_cast<Real>(random.symmetric(n < 15 ? pi : 40));
        wide_q[i] = static_cast<long double>(q[i]);
      }
      const tests::WideFrame truth =
          wide_forward_terms(m->geometry, m->transmission, static_cast<long double>(m->payload_kg), wide_q);
      Pose<Real> pose{};
      ASSERT_EQ(forward(m->arm, q, pose), Status::ok);
      Pose<double> wide_pose{};
      for (int k = 0; k < 4; ++k) wide_pose.quaternion[k] = static_cast<double>(pose.quaternion[k]);
      for (int k = 0; k < 3; ++k) wide_pose.position_m[k] = static_cast<double>(pose.position_m[k]);
      worst_m = std::max(worst_m, tests::position_difference(truth, wide_pose));
      worst_rad = std::max(worst_rad, tests::rotation_difference(truth, wide_pose));
      Pose<Real> same{};
      Jacobian<Real> jacobian;
      ASSERT_EQ(forward(m->arm, q, same, jacobian), Status::ok);
      for (int k = 0; k < 4; ++k) ASSERT_EQ(pose.quaternion[k], same.quaternion[k]);
      for (int k = 0; k < 3; ++k) ASSERT_EQ(pose.position_m[k], same.position_m[k]);
      Frame<Real> frames[max_joints + 2];
      ASSERT_EQ(link_frames(m->arm, q, frames), Status::ok);
      for (int k = 0; k < 3; ++k) ASSERT_EQ(pose.position_m[k], frames[m->geometry.joint_count + 1].position_m[k]);
    }
  }
  std::printf("worst %.3g m %.3g rad\n", worst_m, worst_rad);
  EXPECT_LT(worst_m, bound_m);
  EXPECT_LT(worst_rad, bound_rad);
}

TEST(ForwardWithTerms, IsTheSeriesAndTheTorqueInDouble) { compare<double>(1e-9, 1e-9); }
TEST(ForwardWithTerms, IsTheSeriesAndTheTorqueInFloat) { compare<float>(5e-5, 5e-5); }

TEST(ForwardWithTerms, ItsJacobianIsTheDerivativeByTheReadings) {
  Random random(1811);
  const auto m = std::make_unique<Made<double>>();
  double worst = 0;
  for (int kind = 0; kind < cases(210); ++kind) {
    make(random, kind, *m);
    for (int n = 0; n < 5; ++n) {
      double q[max_joints] = {};
      for (int i = 0; i < m->geometry.joint_count; ++i) q[i] = random.symmetric(pi);
      Pose<double> pose{};
      Jacobian<double> jacobian;
      ASSERT_EQ(forward(m->arm, q, pose, jacobian), Status::ok);
      Frame<double> frames[max_joints + 2];
      ASSERT_EQ(link_frames(m->arm, q, frames), Status::ok);
      const tests::WideFrame here = tests::wide(frames[m->geometry.joint_count + 1]);
      constexpr long double h = 1e-6L;
      for (int j = 0; j < m->geometry.joint_count; ++j) {
        tests::WideFrame side[2];
        for (int s = 0; s < 2; ++s) {
          long double moved[max_joints];
          for (int i = 0; i < m->geometry.joint_count; ++i) moved[i] = static_cast<long double>(q[i]) + (i == j ? (s == 0 ? -h : h) : 0);
          side[s] = wide_forward_terms(m->geometry, m->transmission, static_cast<long double>(m->payload_kg), moved);
        }
        // The angular velocity: R' R^T is skew.
        long double skew[3][3] = {};
        for (std::size_t a = 0; a < 3; ++a) {
          for (std::size_t b = 0; b < 3; ++b) {
            for (std::size_t k = 0; k < 3; ++k) skew[a][b] += (side[1].m[a][k] - side[0].m[a][k]) / (2 * h) * here.m[b][k];
          }
        }
        const long double truth[6] = {(side[1].m[0][3] - side[0].m[0][3]) / (2 * h), (side[1].m[1][3] - side[0].m[1][3]) / (2 * h),
                                      (side[1].m[2][3] - side[0].m[2][3]) / (2 * h), skew[2][1], skew[0][2], skew[1][0]};
        for (int k = 0; k < 6; ++k) {
          worst = std::max(worst, std::fabs(static_cast<double>(truth[k]) - jacobian.column[j][k]));
        }
      }
    }
  }
  std::printf("worst %.3g\n", worst);
  // The interpolation's slope; the tick's Newton steps need no more.
  EXPECT_LT(worst, 1e-7);
}

TEST(TickWithTerms, ReturnsToTheReadings) {
  Random random(1812);
  const auto m = std::make_unique<Made<double>>();
  int regular = 0, same = 0;
  long evaluations = 0;
  for (int kind = 0; kind < cases(700); ++kind) {
    make(random, kind, *m);
    const int joints = m->geometry.joint_count;
    if (joints == 5) continue;
    for (int n = 0; n < 10; ++n) {
      double q[max_joints], truth[max_joints];
      for (int i = 0; i < joints; ++i) {
        truth[i] = random.symmetric(pi);
        q[i] = truth[i] + random.symmetric(0.00314);
      }
      Pose<double> target{}, reached{};
      ASSERT_EQ(forward(m->arm, truth, target), Status::ok);
      TickReport<double> report{};
      const Status status = tick(m->arm, default_tick_options(m->arm), target, q, &report);
      if (!(report.smallest_singular_value > 0.03)) continue;
      ++regular;
      evaluations += report.iterations;
      ASSERT_EQ(status, Status::ok) << kind << " " << n;
      ASSERT_EQ(forward(m->arm, q, reached), Status::ok);
      for (int k = 0; k < 3; ++k) ASSERT_NEAR(reached.position_m[k], target.position_m[k], 1e-10) << kind;
      bool near = true;
      for (int i = 0; i < joints; ++i) near = near && std::fabs(q[i] - truth[i]) < 1e-8;
      if (near || joints == 7) ++same;
    }
  }
  EXPECT_GT(regular, cases(700) * 3);
  EXPECT_EQ(same, regular);
  std::printf("%d regular, %.3f evaluations\n", regular, static_cast<double>(evaluations) / regular);
}

TEST(ForwardWithTerms, WithoutTermsIsTheArmWithoutThem) {
  Random random(1813);
  const Transmission none{};
  const auto table = std::make_unique<JointFunctionTable>();
  for (int kind = 0; kind < cases(70); ++kind) {
    const Geometry g = some_arm(random, kind);
    Arm<double> plain{}, arm{};
    ASSERT_EQ(make_arm(g, plain), Status::ok);
    ASSERT_EQ(make_arm(g, none, *table, arm), Status::ok);
    double q[max_joints] = {};
    for (int i = 0; i < g.joint_count; ++i) q[i] = random.symmetric(pi);
    Pose<double> a{}, b{};
    ASSERT_EQ(forward(plain, q, a), Status::ok);
    ASSERT_EQ(forward(arm, q, b), Status::ok);
    for (int k = 0; k < 4; ++k) ASSERT_EQ(a.quaternion[k], b.quaternion[k]);
    for (int k = 0; k < 3; ++k) ASSERT_EQ(a.position_m[k], b.position_m[k]);
  }
}

}  // namespace
