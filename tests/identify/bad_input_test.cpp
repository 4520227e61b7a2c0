// SPDX-License-Identifier: MIT
// What must be recognised and named, and never yield a confident wrong result.
#include <gtest/gtest.h>

#include <cmath>

#include "offline/base/error.hpp"
#include "offline/base/random.hpp"
#include "offline/identify/mistakes/diagnose.hpp"
#include "offline/robot/vectors.hpp"
#include "offline/simulate/family.hpp"
#include "tests/identify/simulated.hpp"

namespace {

using namespace mdhcal;
using namespace mdhcal::offline;
using namespace mdhcal::tests;

Simulation arm() { return simulate(family_robot("three-parallel"), arm_options(11)); }

template <class Error>
std::string said(const Robot& robot, const Dataset& data, const CalibrationOptions& options = {}) {
  try {
    Calibration c = calibrate(robot, data, options);
    (void)explain_by_mistakes({robot, data, options}, false, c);
    std::string reasons;
    for (const std::string& reason : c.reasons) reasons += reason + ' ';
    if (!reasons.empty()) return reasons;
  } catch (const Error& e) {
    return e.what();
  } catch (const std::exception& e) {
    return std::string("another error: ") + e.what();
  }
  return "no error";
}

bool holds(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(BadInput, AllPosesEqual) {
  Simulation s = arm();
  for (Measurement& m : s.train.rows) m.q = s.train.rows.front().q;
  EXPECT_TRUE(holds(said<InputError>(s.nominal, s.train), "same joint readings"));
}

TEST(BadInput, AllMeasurementsOnePoint) {
  Simulation s = arm();
  for (Measurement& m : s.train.rows) m.position_m = {0, 0, 0};
  EXPECT_TRUE(holds(said<InputError>(s.nominal, s.train), "same point"));
}

// Measured again by the true arm, at other readings.
void measure_again(Simulation& s) {
  const MeasurementModel truth = truth_model(s);
  Random random(17);
  for (Measurement& m : s.train.rows) {
    m.position_m = truth.target_position(m.q.data(), 0);
    for (double& c : m.position_m) c += 0.02e-3 * random.normal();
  }
}

// From one orientation to many, the verdict changes once: where base and target are told by less than the nominal geometry is
// wrong, the reason says by how much.
TEST(BadInput, HardlyTurningFlange) {
  for (const double turn_rad : {0.0, 1e-4, 1e-3}) {
    // Three parallel axes and a wrist that turns back: q4 keeps the sum.
    Simulation s = arm();
    for (std::size_t i = 0; i < s.train.rows.size(); ++i) {
      Measurement& m = s.train.rows[i];
      m.q[0] = 0.3;
      m.q[4] = 0.7 + turn_rad * std::sin(static_cast<double>(i));
      m.q[5] = -0.4 + turn_rad * std::cos(2.0 * static_cast<double>(i));
      m.q[3] = 0.2 - m.q[1] - m.q[2] + turn_rad * std::cos(static_cast<double>(i));
    }
    measure_again(s);
    const Calibration c = calibrate(s.nominal, s.train, {});
    EXPECT_FALSE(c.usable()) << turn_rad;
    const std::string reasons = said<Refusal>(s.nominal, s.train);
    EXPECT_TRUE(holds(reasons, "Base frame and targets are")) << turn_rad << ' ' << reasons;
    EXPECT_TRUE(holds(reasons, "and the flange turns by at most")) << turn_rad << ' ' << reasons;
  }
}

// Only joint 1 moves, and little: the points lie near a line, and the base may turn about it.
TEST(BadInput, PointsOnOneLine) {
  Simulation s = arm();
  Robot robot = s.nominal;
  CalibrationOptions options;
  options.fit_tool = false;
  const MeasurementModel truth = truth_model(s);
  robot.tool_p_m = truth.estimate().flange_p_m.front();
  for (std::size_t i = 0; i < s.train.rows.size(); ++i) {
    Measurement& m = s.train.rows[i];
    for (std::size_t j = 1; j < 6; ++j) m.q[j] = 0.3 + 0.1 * static_cast<double>(j);
    m.q[0] = 0.2 + 1e-3 * static_cast<double>(i);
  }
  measure_again(s);
  const std::string reasons = said<Refusal>(robot, s.train, options);
  EXPECT_TRUE(holds(reasons, "Base frame and targets are")) << reasons;
  EXPECT_TRUE(holds(reasons, "mm along their principal axes")) << reasons;
}

TEST(BadInput, JointAnglesInTheWrongUnit) {
  Simulation s = arm();
  for (Measurement& m : s.train.rows) {
    for (double& q : m.q) q *= 3.14159265358979323846 / 180.0;
  }
  EXPECT_TRUE(holds(said<Refusal>(s.nominal, s.train), "With the joint angles in radians"));
}

TEST(BadInput, PositionsInTheWrongUnit) {
  Simulation s = arm();
  for (Measurement& m : s.train.rows) {
    for (double& x : m.position_m) x *= 1e-3;
  }
  EXPECT_TRUE(holds(said<Refusal>(s.nominal, s.train), "With the measured positions in metres"));
}

TEST(BadInput, TwoJointsSwapped) {
  Simulation s = arm();
  for (Measurement& m : s.train.rows) std::swap(m.q[1], m.q[4]);
  EXPECT_TRUE(holds(said<Refusal>(s.nominal, s.train), "With q2 and q5 swapped"));
}

TEST(BadInput, TwoJointsSwappedInAFileWithSigma) {
  SimulationOptions options = arm_options(11);
  options.state_sigma = true;
  Simulation s = simulate(family_robot("three-parallel"), options);
  for (Measurement& m : s.train.rows) std::swap(m.q[1], m.q[4]);
  EXPECT_TRUE(holds(said<Refusal>(s.nominal, s.train), "With q2 and q5 swapped"));
}

// Whichever two joints: named, and if the arm's symmetry hides which two, refused all the same.
TEST(BadInput, NoSwapOfTwoJointsYieldsAResult) {
  for (const std::string& family : family_names()) {
    const Simulation s = simulate(family_robot(family), arm_options(11));
    for (std::size_t i = 0; i < s.train.joint_count; ++i) {
      for (std::size_t j = i + 1; j < s.train.joint_count; ++j) {
        Dataset swapped = s.train;
        for (Measurement& m : swapped.rows) std::swap(m.q[i], m.q[j]);
        const std::string what = said<Refusal>(s.nominal, swapped);
        EXPECT_TRUE(holds(what, "With q" + std::to_string(i + 1) + " and q" + std::to_string(j + 1) + " swapped"))
            << family << ": " << what;
      }
    }
  }
}

TEST(BadInput, AJointCountedTheOtherWayRound) {
  Simulation s = arm();
  for (Measurement& m : s.train.rows) m.q[2] = -m.q[2];
  EXPECT_TRUE(holds(said<Refusal>(s.nominal, s.train), "With q3 reversed"));
}

TEST(BadInput, TrackerMovedBetweenTwoSeries) {
  for (double shift_m : {1e-3, 20e-3}) {
    Simulation s = arm();
    const Frame<double> move = rotation_about({1e-3, -2e-3, 0.5e-3}, {1.0, 0.0, 0.0});
    for (std::size_t i = 30; i < s.train.rows.size(); ++i) {
      Vector3& p = s.train.rows[i].position_m;
      p = transform(move, p);
      p[0] += shift_m;
    }
    EXPECT_TRUE(holds(said<Refusal>(s.nominal, s.train), "moved before row")) << shift_m;
  }
}

TEST(BadInput, TrackerMovedIsSeenAlsoWithSigmaAndWithTheBaseGiven) {
  for (const bool given : {false, true}) {
    SimulationOptions options = arm_options(12);
    options.state_sigma = !given;
    options.base_frame = given;
    Simulation s = simulate(family_robot("spherical-wrist"), options);
    for (std::size_t i = 25; i < s.train.rows.size(); ++i) s.train.rows[i].position_m[1] += 2e-3;
    CalibrationOptions calibration;
    calibration.fit_base = !given;
    EXPECT_TRUE(holds(said<Refusal>(s.nominal, s.train, calibration), "moved before row 26")) << given;
  }
}

// The whole of the sweep's false alarms, thinned; docs/method.md has the sensitivity.
TEST(BadInput, NoTrackerMoveIsClaimedOnCleanData) {
  for (const std::string& family : family_names()) {
    for (std::uint64_t seed = 301; seed < 321; ++seed) {
      SimulationOptions options = arm_options(seed);
      options.noise_m = seed % 2 == 0 ? 0.02e-3 : 0.1e-3;  // as stated, and five times that
      const Simulation s = simulate(family_robot(family), options);
      EXPECT_EQ(said<Refusal>(s.nominal, s.train), "no error") << family << ' ' << seed;
    }
  }
}

TEST(BadInput, ReflectorOnTheLastAxis) {
  Robot robot = family_robot("three-parallel");
  robot.tool_p_m = Vector3{0.0, 0.0, 0.1};
  const Simulation s = simulate(robot, arm_options(5));
  Dataset data = s.train;
  // Measured again with the target exactly on the axis of the true arm.
  Estimate truth;
  truth.geometry = s.truth.geometry;
  truth.flange_p_m = {{0.0, 0.0, 0.1}};
  const MeasurementModel real(truth);
  for (Measurement& m : data.rows) m.position_m = real.target_position(m.q.data(), 0);
  const Calibration c = calibrate(s.nominal, data, {});
  bool named = false;
  for (const std::string& note : c.notes) named = named || holds(note, "from the axis of joint 6");
  EXPECT_TRUE(named);
  EXPECT_FALSE(c.identifiability.weak.empty());
  for (const EstimatedParameter& p : c.parameters) {
    EXPECT_TRUE(std::isfinite(p.deviation) && std::isfinite(p.standard_deviation)) << name(p.id);
  }
}

TEST(BadInput, FewerMeasurementsThanBaseAndTargetUnknowns) {
  Simulation s = arm();
  s.train.rows.resize(2);
  EXPECT_TRUE(holds(said<InputError>(s.nominal, s.train), "expected at least 9"));
}

TEST(BadInput, FewerMeasurementsThanUnknownsIsSaid) {
  Simulation s = arm();
  s.train.rows.resize(7);
  const Calibration c = calibrate(s.nominal, s.train, {});
  bool named = false;
  for (const std::string& note : c.notes) named = named || holds(note, "fewer scalar measurements");
  EXPECT_TRUE(named);
}

TEST(BadInput, HalfOfTheRowsGross) {
  Simulation s = arm();
  add_gross_errors(s.train, 0.45, 3);
  EXPECT_TRUE(holds(said<Refusal>(s.nominal, s.train), "more than a third"));
}

TEST(BadInput, UnknownParameterNames) {
  const Simulation s = arm();
  CalibrationOptions options;
  options.parameters.fix = {"a9"};
  EXPECT_TRUE(holds(said<InputError>(s.nominal, s.train, options), "a9"));
}

}  // namespace
