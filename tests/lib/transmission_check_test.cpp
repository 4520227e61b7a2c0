// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>

#include "mdhcal/transmission.hpp"
#include "tests/lib/arms.hpp"
#include "tests/lib/transmissions.hpp"

namespace {

using namespace mdhcal;
using namespace mdhcal::test;

TEST(JointFunctionSeries, IsTheSeriesTimesItsWindow) {
  Random random(1801);
  for (int n = 0; n < cases(400); ++n) {
    const JointFunction f = some_function(random, n % 41 == 0 ? 1 : n % 41, n % 3 == 0 ? 7.0 : random.uniform(1, 6.2));
    for (int k = 0; k < 20; ++k) {
      const double r = random.symmetric(k < 15 ? 7 : 900);
      double value = 1, slope = 1;
      evaluate_joint_function(f, r, value, slope);
      // 900 rad known to 1e-13 and times 40.
      ASSERT_NEAR(value, static_cast<double>(wide_function(f, static_cast<long double>(r))), 1e-15) << n;
      const long double h = 1e-7L;
      const long double difference = (wide_function(f, static_cast<long double>(r) + h) - wide_function(f, static_cast<long double>(r) - h)) / (2 * h);
      ASSERT_NEAR(slope, static_cast<double>(difference), 2e-7) << n;
    }
  }
}

TEST(JointFunctionSeries, HoldsWhereReadingsWereSeenAndIsZeroFarOutside) {
  JointFunction f{};
  f.order_count = 1;
  f.cosine_rad[0] = 0.001F;
  f.seen_min_rad = -1;
  f.seen_max_rad = 1;
  double value = 0, slope = 0;
  evaluate_joint_function(f, 0.9 + 2 * pi, value, slope);
  EXPECT_NEAR(value, static_cast<double>(0.001F) * std::cos(0.9), 1e-15);
  evaluate_joint_function(f, 1.5, value, slope);
  EXPECT_EQ(value, 0);
  EXPECT_EQ(slope, 0);
  evaluate_joint_function(f, std::numeric_limits<double>::quiet_NaN(), value, slope);
  EXPECT_EQ(value, 0);
}

// Each way to be wrong, by status.
TEST(CheckTransmission, RefusesByName) {
  Random random(1802);
  Geometry arm = ur5();
  arm.joint[5].kind = JointKind::prismatic;
  arm.joint[5].has_min = arm.joint[5].has_max = 1;
  arm.joint[5].max = 0.1;
  const auto good = std::make_unique<Transmission>(some_transmission(random, ur5()));
  Transmission& t = *good;
  EXPECT_EQ(check_transmission(ur5(), t), Status::ok);
  EXPECT_EQ(check_transmission(arm, t), Status::bad_input) << "a joint that slides has a function";
  const auto changed = [&](auto change) {
    const auto other = std::make_unique<Transmission>(t);
    change(*other);
    return check_transmission(ur5(), *other);
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(changed([&](Transmission& x) { x.function[1].cosine_rad[3] = std::nanf(""); }), Status::bad_input);
  EXPECT_EQ(changed([&](Transmission& x) { x.function[1].order_count = 41; }), Status::bad_input);
  EXPECT_EQ(changed([&](Transmission& x) { x.function[1].order_count = -1; }), Status::bad_input);
  EXPECT_EQ(changed([&](Transmission& x) { x.function[1].order_count = 5; }), Status::bad_input) << "orders beyond the count";
  EXPECT_EQ(changed([&](Transmission& x) { x.function[1].reserved = 1; }), Status::bad_input);
  EXPECT_EQ(changed([&](Transmission& x) { x.function[1].seen_max_rad = x.function[1].seen_min_rad; }), Status::bad_input);
  EXPECT_EQ(changed([&](Transmission& x) { x.function[1].seen_min_rad = nan; }), Status::bad_input);
  EXPECT_EQ(changed([&](Transmission& x) { x.function[1].seen_max_rad = x.function[1].seen_min_rad + 0.05; }), Status::bad_input)
      << "less than a sector";
  EXPECT_EQ(changed([&](Transmission& x) { x.function[7] = x.function[1]; }), Status::bad_input) << "no such joint";
  EXPECT_EQ(changed([&](Transmission& x) { x.function[7].seen_max_rad = 1; }), Status::bad_input);
  EXPECT_EQ(changed([&](Transmission& x) { x.function[1].cosine_rad[0] += 0.006F; }), Status::blob_deviation);
  EXPECT_EQ(changed([&](Transmission& x) { x.function[1].sine_rad[39] += 0.0026F; }), Status::blob_deviation) << "slope";
  EXPECT_EQ(changed([&](Transmission& x) { x.gravity.direction[2] = -0.5; }), Status::bad_input);
  EXPECT_EQ(changed([&](Transmission& x) { x.gravity.direction[0] = nan; }), Status::bad_input);
  EXPECT_EQ(changed([&](Transmission& x) { for (double& g : x.gravity.direction) g = 0; }), Status::bad_input);
  EXPECT_EQ(changed([&](Transmission& x) { x.gravity.compliance[3][2] = 1e-4; }), Status::bad_input) << "a link before the joint";
  EXPECT_EQ(changed([&](Transmission& x) { x.gravity.compliance[1][7] = 1e-4; }), Status::bad_input);
  EXPECT_EQ(changed([&](Transmission& x) { x.gravity.compliance[1][3] = nan; }), Status::bad_input);
  EXPECT_EQ(changed([&](Transmission& x) { x.gravity.compliance[1][3] = 0.1; }), Status::blob_deviation);
  EXPECT_EQ(changed([&](Transmission& x) { x.gravity.payload_kg = -1; }), Status::bad_input);
  EXPECT_EQ(changed([&](Transmission& x) { x.gravity.payload_com_m[1] = nan; }), Status::bad_input);
  EXPECT_EQ(changed([&](Transmission& x) { x.gravity.payload_compliance[6] = 1e-6; }), Status::bad_input);
  EXPECT_EQ(check_transmission(Geometry{}, t), Status::bad_input);
  const Transmission none{};
  EXPECT_EQ(check_transmission(arm, none), Status::ok);
}

}  // namespace
