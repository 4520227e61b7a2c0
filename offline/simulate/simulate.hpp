// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "offline/base/random.hpp"
#include "offline/measure/dataset.hpp"
#include "offline/robot/random_readings.hpp"
#include "offline/robot/robot.hpp"

namespace mdhcal::offline {

/// What simulate() makes. Standard deviations are of normal errors, one draw an axis or parameter.
struct SimulationOptions {
  std::uint64_t seed = 1;
  std::size_t configurations = 50;       ///< of the training set
  std::size_t test_configurations = 200; ///< of the test set
  std::size_t repeats = 1;               ///< visits of each configuration; > 1 makes each a group
  std::size_t targets = 1;               ///< reflectors on the flange, 1 ... 8
  bool full_pose = false;                ///< rows also carry the rotation

  double length_error_m = 0.5e-3;        ///< of a, d and the target points' coordinates [m]
  double angle_error_rad = 0.5e-3;       ///< of alpha, offset and beta [rad]
  double noise_m = 0.02e-3;              ///< of the measured positions, each axis [m]
  double rotation_noise_rad = 0.05e-3;   ///< of the measured rotations, each axis [rad] (full_pose only)
  double joint_noise_rad = 0;            ///< of what a joint does about what it reads [rad] (prismatic: [m])
  double joint_function_rad = 0;         ///< amplitude of every joint's function on the orders 1, 2, 10, 18 and 28 [rad]
  double sag_rad = 0;                    ///< of every joint when the arm is stretched out level [rad]
  double outlier_fraction = 0;           ///< of the training rows, in [0, 1)
  double outlier_m = 5e-3;               ///< length of an outlier's error, in a random direction [m]

  bool state_sigma = false;              ///< rows carry `sigma` = noise_m
  bool base_frame = false;               ///< positions in the robot's base frame: tracker_T_base is the identity
};

/// A simulated robot and its measurements.
struct Simulation {
  Robot nominal;                         ///< what the robot's maker states, with nominal target points
  Robot truth;                           ///< what the robot is: geometry, tracker_T_base, targets
  Dataset train;
  Dataset test;                          ///< other configurations, with noise, without outliers
  std::vector<std::size_t> outlier_rows; ///< indices into train.rows, ascending
};

/// Gives the robot errors and measures it in random configurations within its joint limits.
/// Errors go to exactly those parameters that a fit of base and target leaves free: link 1
/// (but for beta) and the last link's d and offset stay nominal, and where axis i is within 5 degrees of parallel to
/// axis i + 1, beta_i takes the place of d_i. So the truth is comparable, parameter by parameter, with a calibration.
/// The same robot and options give the same result. `progress`, if given, is called with the configurations done and all
/// of them. Throws InputError if an option is out of its range.
Simulation simulate(const Robot& robot, const SimulationOptions& options,
                    const std::function<void(std::size_t, std::size_t)>& progress = {});

}  // namespace mdhcal::offline
