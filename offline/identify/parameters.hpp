// SPDX-License-Identifier: MIT
// Which numbers of the geometry are estimated, on which scale, and why the others are not.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "offline/robot/robot.hpp"

namespace mdhcal::offline {

/// The parameters of one link in the modified convention.
enum class ParameterKey : std::int32_t { alpha = 0, a = 1, theta = 2, d = 3, beta = 4 };

/// One parameter: its key and its link, from 0. Named by key and [[link]] number from 1: "alpha2".
struct ParameterId {
  ParameterKey key = ParameterKey::alpha;
  std::int32_t link = 0;
  bool operator==(const ParameterId&) const = default;
};

std::string name(ParameterId id);
/// The inverse of name(); empty if the word names no parameter of an arm with `joint_count` joints.
std::optional<ParameterId> parse_parameter(const std::string& word, std::int32_t joint_count);
bool is_angle(ParameterId id);
double value(const Geometry& geometry, ParameterId id);           ///< [rad] or [m]
void set_value(Geometry& geometry, ParameterId id, double value); ///< [rad] or [m]

/// An estimated parameter.
struct Parameter {
  ParameterId id{};
  double nominal = 0;  ///< centre of the prior [rad] or [m]
  double prior = 1e-3; ///< prior standard deviation [rad] or [m]; the unit in which the deviation is estimated
};

/// What the measurements fix of the frames at both ends; decides the gauge.
struct Gauge {
  bool base_fitted = true;
  bool target_fitted = true;
};

struct ParameterChoice {
  std::vector<std::string> fix;         ///< names kept at nominal
  std::vector<std::string> free;        ///< names estimated although the default keeps them
  double parallel_rad = 0.0872664625997164788; ///< axes closer than this get a beta (5 degrees)
  double prior_length_m = 1e-3;
  double prior_angle_rad = 1e-3;
};

struct ParameterList {
  std::vector<Parameter> free;        ///< in the order link by link: alpha, a, theta, d, beta
  std::vector<std::string> decisions; ///< one sentence a decision, to be said
  std::vector<std::string> betas;     ///< names of the betas that are free
};

/// Decides which parameters are free: all four of each link and beta where axis i is parallel to axis i+1 within
/// `parallel_rad` (d_i then stays nominal: d_{i+1} carries the offset), less what the gauge confounds.
/// Throws InputError for an unknown name in `choice` or in the robot's [prior].
ParameterList choose_parameters(const Robot& robot, const Gauge& gauge, const ParameterChoice& choice);

}  // namespace mdhcal::offline
