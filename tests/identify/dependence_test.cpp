// SPDX-License-Identifier: MIT
// Temperature and direction of approach: seen in the residual where they were put in, not claimed where they were not.
#include "offline/identify/dependence.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "offline/base/random.hpp"
#include "offline/robot/vectors.hpp"
#include "offline/simulate/family.hpp"
#include "tests/identify/simulated.hpp"

namespace {

using namespace mdhcal;
using namespace mdhcal::offline;
using namespace mdhcal::tests;

// 60 poses with a temperature that drifts up and a direction that changes by chance.
Simulation recorded(std::uint64_t seed) {
  Simulation s = simulate(family_robot("three-parallel"), arm_options(seed));
  Random random(500 + seed);
  for (std::size_t i = 0; i < s.train.rows.size(); ++i) {
    s.train.temperature.push_back(20.0 + 0.1 * static_cast<double>(i) + 0.2 * random.normal());
    s.train.direction.push_back(random.uniform() < 0.5 ? "up" : "down");
  }
  return s;
}

std::size_t claims(const Calibration& c) {
  std::size_t count = 0;
  for (const std::string& note : c.notes) count += note.rfind("The residual goes with", 0) == 0 ? 1U : 0U;
  return count;
}

TEST(Dependence, NoneIsClaimedWhereNoneIs) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const Simulation s = recorded(seed);
    const Calibration c = calibrate(s.nominal, s.train, {});
    ASSERT_EQ(c.dependences.size(), 3U);
    EXPECT_EQ(c.dependences[0].quantity, "temperature");
    EXPECT_EQ(c.dependences[0].count + c.train.outliers.size(), 60U);
    EXPECT_EQ(c.dependences[1].quantity, "direction down");
    EXPECT_EQ(claims(c), 0U) << "seed " << seed;
  }
}

TEST(Dependence, TheTestsLevelIsWhatItSays) {
  // Without an effect the p value is uniform: of 120 values about 12 lie below 0.1, more than 24 with probability 0.0006.
  std::size_t below = 0;
  for (std::uint64_t seed = 1; seed <= 120; ++seed) {
    const Simulation s = recorded(seed);
    below += calibrate(s.nominal, s.train, {}).dependences[0].p_value < 0.1 ? 1U : 0U;
  }
  EXPECT_LE(below, 24U);
  EXPECT_GE(below, 3U);
}

TEST(Dependence, AnArmThatGrowsWithTheTemperatureIsSeen) {
  Simulation s = recorded(3);
  const Vector3 foot = transform(frame_of(*s.truth.tracker_T_base), {0.0, 0.0, 0.0});
  for (std::size_t i = 0; i < s.train.rows.size(); ++i) {
    // 25 micrometres a metre and degree, about twice that of steel.
    const double growth = 25e-6 * (s.train.temperature[i] - 20.0);
    Vector3& p = s.train.rows[i].position_m;
    for (std::size_t k = 0; k < 3; ++k) p[k] += growth * (p[k] - foot[k]);
  }
  const Calibration c = calibrate(s.nominal, s.train, {});
  EXPECT_LT(c.dependences[0].p_value, 1e-6);
  EXPECT_EQ(claims(c), 1U);
  // Predicted minus measured, in mm a metre: the arm's growth with its sign turned.
  EXPECT_NEAR(c.dependences[0].effects[3], -0.025, 0.008);
}

TEST(Dependence, BacklashIsSeenInTheDirectionOfApproach) {
  Simulation s = recorded(4);
  const MeasurementModel real = truth_model(s);
  for (std::size_t i = 0; i < s.train.rows.size(); ++i) {
    Measurement& m = s.train.rows[i];
    auto behind = m.q;
    behind[1] += s.train.direction[i] == "up" ? 0.1e-3 : -0.1e-3;  // 0.006 degrees either way
    const Vector3 moved = minus(real.target_position(behind.data(), 0), real.target_position(m.q.data(), 0));
    for (std::size_t k = 0; k < 3; ++k) m.position_m[k] += moved[k];
  }
  const Calibration c = calibrate(s.nominal, s.train, {});
  EXPECT_EQ(claims(c), 2U);
  ASSERT_EQ(c.dependences[2].quantity, "direction up");
  // 0.2 mrad between the two directions, in joint 2 alone.
  EXPECT_NEAR(c.dependences[2].effects[1], -0.2, 0.05);
  EXPECT_LT(std::fabs(c.dependences[2].effects[0]), 0.05);
}

}  // namespace
