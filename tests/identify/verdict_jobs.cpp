// SPDX-License-Identifier: MIT
#include "tests/identify/verdict_jobs.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "offline/base/random.hpp"
#include "offline/robot/random_readings.hpp"
#include "offline/robot/vectors.hpp"
#include "offline/simulate/family.hpp"
#include "tests/identify/simulated.hpp"

namespace mdhcal::tests {

using namespace offline;

namespace {

constexpr double noise_m = 0.02e-3;

// The arm as it is: geometry, and what its joints do about what they read.
struct RealArm {
  Simulation simulation;
  MeasurementModel model;
  double sag[3] = {0, 0, 0};                    // [rad]
  double period[max_joints][2] = {};            // amplitudes of one and two periods a turn [rad]
  double phase[max_joints][2] = {};

  Vector3 target_m(Joints q) const {
    const Joints r = q;
    q[1] += sag[0] * std::cos(r[1]) + sag[1] * std::cos(r[1] + r[2]);
    q[2] += sag[2] * std::cos(r[1] + r[2]);
    for (std::size_t j = 0; j < max_joints; ++j) {
      for (int k = 0; k < 2; ++k) q[j] += period[j][k] * std::cos((k + 1) * r[j] + phase[j][k]);
    }
    return model.target_position(q.data(), 0);
  }
};

RealArm real_arm(std::uint64_t seed, bool sag, bool joint_function) {
  Random random(seed * 7919 + 1);
  SimulationOptions options = arm_options(seed);
  options.configurations = 1;
  const double size = std::exp(random.uniform(std::log(0.3), std::log(2.0)));
  options.length_error_m = 1e-3 * size;
  options.angle_error_rad = 1e-3 * size;
  Simulation simulation = simulate(family_robot(family_names()[seed % family_names().size()]), options);
  RealArm arm{simulation, truth_model(simulation)};
  if (sag) {
    for (double& each : arm.sag) each = 1e-3 * random.uniform(0.1, 0.5);
  }
  if (joint_function) {
    for (std::int32_t j = 0; j < simulation.truth.geometry.joint_count; ++j) {
      for (int k = 0; k < 2; ++k) {
        arm.period[j][k] = 1e-3 * random.uniform(0.05, 0.3);
        arm.phase[j][k] = random.uniform(0.0, 2.0 * std::numbers::pi);
      }
    }
  }
  return arm;
}

Dataset measured(const RealArm& arm, std::size_t count, Random& random) {
  Dataset out;
  out.path = "simulated";
  out.joint_count = static_cast<std::size_t>(arm.simulation.truth.geometry.joint_count);
  out.targets = {""};
  for (std::size_t i = 0; i < count; ++i) {
    Measurement row;
    row.id = std::to_string(i + 1);
    row.group = static_cast<std::uint32_t>(i);
    row.line = static_cast<long>(i) + 2;
    row.q = random_readings(arm.simulation.truth.geometry, random);
    row.position_m = arm.target_m(row.q);
    for (double& c : row.position_m) c += noise_m * random.normal();
    out.groups.push_back(row.id);
    out.rows.push_back(row);
  }
  return out;
}

// Which of the kinds a seed is: independent of the kind of arm and of the number of poses.
bool has_sag(std::uint64_t seed) { return seed % 20 < 5; }
bool has_joint_function(std::uint64_t seed) { return seed % 20 >= 5 && seed % 20 < 10; }
bool has_gross(std::uint64_t seed) { return (seed / 4) % 10 == 3; }

}  // namespace

VerdictJob verdict_job(std::uint64_t seed) {
  VerdictJob job;
  Random random(seed * 104729 + 3);
  job.family = family_names()[seed % family_names().size()];
  job.poses = static_cast<std::size_t>(std::lround(std::exp(random.uniform(std::log(5.5), std::log(80.5)))));
  job.sag = has_sag(seed);
  job.joint_function = has_joint_function(seed);
  job.gross = has_gross(seed);
  const RealArm arm = real_arm(seed, job.sag, job.joint_function);
  job.nominal = arm.simulation.nominal;
  job.train = measured(arm, job.poses, random);
  job.test = measured(arm, 15, random);
  if (job.gross) {
    add_gross_errors(job.train, std::max(0.05, 1.0 / static_cast<double>(job.poses)), seed);
  }
  return job;
}

VerdictOutcome outcome_of(const VerdictJob& job, std::uint64_t seed, bool held_out) {
  const Calibration c = calibrate(job.nominal, job.train, {}, held_out ? &job.test : nullptr);
  VerdictOutcome out;
  const SplitFigures& figures = c.judged();
  out.mean = figures.after.mean;
  out.low = figures.mean.low;
  out.high = figures.mean.high;
  out.usable = c.usable();
  out.verdict = c.verdict;
  const RealArm arm = real_arm(seed, job.sag, job.joint_function);
  const MeasurementModel corrected(c.estimate);
  Random random(seed * 15485863 + 5);
  constexpr int others = 1000;
  for (int i = 0; i < others; ++i) {
    const Joints q = random_readings(arm.simulation.truth.geometry, random);
    Vector3 error = minus(corrected.target_position(q.data(), 0), arm.target_m(q));
    out.noise_free += 1e3 * norm(error) / others;
    for (double& component : error) component += noise_m * random.normal();
    out.truth += 1e3 * norm(error) / others;
  }
  return out;
}

}  // namespace mdhcal::tests
