// SPDX-License-Identifier: MIT
#include "offline/output/blob_writer.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "mdhcal/arm.hpp"
#include "offline/base/error.hpp"
#include "offline/output/posture_family.hpp"
#include "offline/output/self_test_vectors.hpp"

namespace mdhcal::offline {

namespace {

// The inverse's tolerances that every blob states, those of default_tick_options().
constexpr Tolerances default_tolerances{1e-10, 1e-10, 5e-6F, 5e-6F};

template <std::size_t size>
void put_text(const Robot& robot, const char* what, const std::string& text, char (&field)[size]) {
  if (text.size() >= size) {
    throw InputError(robot.path, 0, 0,
                     std::string(what) + " '" + text + "' has " + std::to_string(text.size()) + " bytes, expected at most " +
                         std::to_string(size - 1) + ".");
  }
  const bool control = std::any_of(text.begin(), text.end(), [](char c) { return (c >= 0 && c < 0x20) || c == 0x7F; });
  if (control) throw InputError(robot.path, 0, 0, std::string(what) + " contains a control character, expected plain text.");
  std::memset(field, 0, size);
  std::memcpy(field, text.data(), text.size());
}

Pose<double> canonical(Pose<double> pose) {
  if (pose.quaternion[0] < 0.0) {
    for (double& component : pose.quaternion) component = -component;
  }
  return pose;
}

void check_deviation(const Robot& robot) {
  for (std::size_t i = 0; i < static_cast<std::size_t>(robot.geometry.joint_count); ++i) {
    const Link& is = robot.geometry.link[i];
    const Link& was = robot.nominal[i];
    const std::string number = std::to_string(i + 1);
    const auto hold = [&](const char* name, double deviation, double bound, const char* unit) {
      if (std::fabs(deviation) <= bound) return;
      throw Refusal("The corrected " + (name + number) + " is " + std::to_string(deviation * 1e3) + " " + unit +
                    " from its nominal value, expected at most " + std::to_string(bound * 1e3) + " " + unit +
                    ": a controller refuses such a blob.");
    };
    hold("alpha", is.alpha_rad - was.alpha_rad, max_deviation_rad(), "mrad");
    hold("a", is.a_m - was.a_m, max_deviation_m(), "mm");
    hold("theta", is.theta_rad - was.theta_rad, max_deviation_rad(), "mrad");
    hold("d", is.d_m - was.d_m, max_deviation_m(), "mm");
    hold("beta", is.beta_rad - was.beta_rad, max_deviation_rad(), "mrad");
  }
}

void put_targets(const Robot& robot, BlobContent& model) {
  std::vector<TargetPoint> targets = robot.targets;
  if (targets.empty() && robot.tool_p_m) targets.push_back({"tool", *robot.tool_p_m});
  if (targets.size() > max_targets) {
    throw InputError(robot.path, 0, 0,
                     "The robot has " + std::to_string(targets.size()) + " target points, expected at most " +
                         std::to_string(max_targets) + ".");
  }
  model.target_count = static_cast<std::int32_t>(targets.size());
  for (std::size_t i = 0; i < targets.size(); ++i) {
    put_text(robot, "The target's name", targets[i].name, model.target[i].name);
    std::copy(targets[i].flange_p_m.begin(), targets[i].flange_p_m.end(), model.target[i].flange_p_m);
  }
}

std::uint8_t hexadecimal(char digit) {
  if (digit >= '0' && digit <= '9') return static_cast<std::uint8_t>(digit - '0');
  if (digit >= 'a' && digit <= 'f') return static_cast<std::uint8_t>(digit - 'a' + 10);
  throw InputError("The digest of the measurements is not 64 lower-case hexadecimal digits.");
}

void put_provenance(const Robot& robot, const Provenance& from, BlobProvenance& to) {
  put_text(robot, "The tool version", from.tool_version, to.tool_version);
  put_text(robot, "The date", from.date, to.date);
  put_text(robot, "The method", from.method, to.method);
  put_text(robot, "The rule of lambda", from.lambda_rule, to.lambda_rule);
  if (!from.measurements_sha256.empty()) {
    if (from.measurements_sha256.size() != 64) hexadecimal('?');
    to.has_measurements = 1;
    to.pose_count = from.pose_count;
    for (std::size_t i = 0; i < 32; ++i) {
      to.measurements_sha256[i] = static_cast<std::uint8_t>(hexadecimal(from.measurements_sha256[2 * i]) << 4 |
                                                            hexadecimal(from.measurements_sha256[2 * i + 1]));
    }
  }
  if (from.lambda) {
    to.has_lambda = 1;
    to.lambda = *from.lambda;
  }
  if (from.held_out) {
    to.has_held_out = 1;
    to.held_out_count = from.held_out->pose_count;
    to.mean_before_m = from.held_out->mean_before_m;
    to.max_before_m = from.held_out->max_before_m;
    to.mean_after_m = from.held_out->mean_after_m;
    to.max_after_m = from.held_out->max_after_m;
  }
}

// Absent limits and unused joints hold what a file said or nothing; in a blob they are zero.
void put_geometry(const Robot& robot, BlobContent& model) {
  const Geometry& from = robot.geometry;
  if (check_geometry(from) != Status::ok) throw InputError(robot.path, 0, 0, "The geometry is not valid: a value is out of range.");
  model.geometry.joint_count = from.joint_count;
  for (std::size_t i = 0; i < static_cast<std::size_t>(from.joint_count); ++i) {
    model.geometry.link[i] = from.link[i];
    model.nominal[i] = robot.nominal[i];
    Joint& joint = model.geometry.joint[i];
    joint = from.joint[i];
    if (joint.has_min == 0) joint.min = 0.0;
    if (joint.has_max == 0) joint.max = 0.0;
  }
  model.geometry.last_T_flange = canonical(from.last_T_flange);
  Geometry nominal = model.geometry;
  std::copy(std::begin(model.nominal), std::end(model.nominal), nominal.link);
  if (check_geometry(nominal) != Status::ok) {
    throw InputError(robot.path, 0, 0, "The nominal geometry is not valid: a value is out of range.");
  }
  model.family = posture_family(nominal);
}

}  // namespace

BlobContent make_model(const Robot& robot, const Provenance& provenance) {
  BlobContent model{};
  put_geometry(robot, model);
  model.transmission = robot.transmission;
  check_deviation(robot);
  put_text(robot, "The robot's name", robot.name, model.name);
  put_text(robot, "The robot's serial", robot.serial, model.serial);
  model.tracker_T_base.quaternion[0] = 1.0;
  if (robot.tracker_T_base) {
    model.has_base = 1;
    model.tracker_T_base = canonical(*robot.tracker_T_base);
  }
  put_targets(robot, model);
  model.tolerances = default_tolerances;
  put_provenance(robot, provenance, model.provenance);
  fill_self_test_vectors(model);
  return model;
}

Blob make_blob(const Robot& robot, const Provenance& provenance) {
  const Blob blob = encode(make_model(robot, provenance));
  BlobContent model;
  const Status status = decode(blob.data(), blob.size(), DecodeOptions{}, model);
  if (status != Status::ok) throw Refusal(robot.path + ": the blob would be refused: " + status_text(status) + ".");
  return blob;
}

}  // namespace mdhcal::offline
