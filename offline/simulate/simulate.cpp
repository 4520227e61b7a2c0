// SPDX-License-Identifier: MIT
#include "offline/simulate/simulate.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>

#include "mdhcal/kinematics.hpp"
#include "offline/base/error.hpp"
#include "offline/base/random.hpp"
#include "offline/robot/units.hpp"
#include "offline/simulate/transmission.hpp"

namespace mdhcal::offline {

namespace {

constexpr double parallel_rad = 5 * rad_per_deg;

void require(bool holds, const char* message) {
  if (!holds) throw InputError(message);
}

void check_options(const SimulationOptions& options) {
  require(options.configurations >= 1, "a simulation needs at least 1 configuration");
  require(options.repeats >= 1, "a simulation needs at least 1 repeat of each configuration");
  require(options.targets >= 1 && options.targets <= 8, "a simulation has 1 to 8 targets");
  for (const double value : {options.length_error_m, options.angle_error_rad, options.noise_m,
                             options.rotation_noise_rad, options.joint_noise_rad, options.joint_function_rad, options.sag_rad, options.outlier_m}) {
    require(std::isfinite(value) && value >= 0, "a simulation's standard deviations are finite and not negative");
  }
  require(options.outlier_fraction >= 0 && options.outlier_fraction < 1, "the fraction of outliers lies in [0, 1)");
}

bool parallel_to_next(const Geometry& geometry, std::size_t i) {
  return i + 1 < static_cast<std::size_t>(geometry.joint_count) &&
         std::abs(std::sin(geometry.link[i + 1].alpha_rad)) < std::sin(parallel_rad);
}

void add_errors(Geometry& geometry, const SimulationOptions& options, Random& random) {
  const auto n = static_cast<std::size_t>(geometry.joint_count);
  for (std::size_t i = 0; i < n; ++i) {
    Link& link = geometry.link[i];
    const bool first = i == 0, last = i + 1 == n, parallel = parallel_to_next(geometry, i);
    if (!first) link.alpha_rad += options.angle_error_rad * random.normal();
    if (!first) link.a_m += options.length_error_m * random.normal();
    if (!first && !last) link.theta_rad += options.angle_error_rad * random.normal();
    if (!first && !last && !parallel) link.d_m += options.length_error_m * random.normal();
    if (parallel) link.beta_rad += options.angle_error_rad * random.normal();
  }
}

// Nominal target points: the tool point and copies of it turned about the flange's z axis, so that no two coincide.
std::vector<TargetPoint> nominal_targets(const Robot& robot, std::size_t count) {
  const Vector3 tool = robot.tool_p_m.value_or(Vector3{0.06, 0.04, 0.08});
  std::vector<TargetPoint> points;
  for (std::size_t k = 0; k < count; ++k) {
    const double turn = 2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(count);
    const double c = std::cos(turn), s = std::sin(turn);
    const std::string name = count == 1 ? "" : std::string(1, static_cast<char>('A' + static_cast<int>(k)));
    points.push_back({name, {c * tool[0] - s * tool[1], s * tool[0] + c * tool[1], tool[2]}});
  }
  return points;
}

Eigen::Vector3d normal_vector(Random& random) {
  Eigen::Vector3d v;
  for (int axis = 0; axis < 3; ++axis) v[axis] = random.normal();
  return v;
}

Eigen::Quaterniond random_rotation(Random& random) {
  Eigen::Vector4d v;
  for (int k = 0; k < 4; ++k) v[k] = random.normal();
  v.normalize();
  if (v[0] < 0) v = -v;
  return {v[0], v[1], v[2], v[3]};
}

Eigen::Quaterniond small_rotation(const Eigen::Vector3d& v) {
  const double angle = v.norm();
  return angle > 0 ? Eigen::Quaterniond(Eigen::AngleAxisd(angle, v / angle)) : Eigen::Quaterniond::Identity();
}

void store(const Eigen::Quaterniond& rotation, double (&quaternion)[4]) {
  const double sign = rotation.w() < 0 ? -1 : 1;
  quaternion[0] = sign * rotation.w();
  quaternion[1] = sign * rotation.x();
  quaternion[2] = sign * rotation.y();
  quaternion[3] = sign * rotation.z();
}

Eigen::Quaterniond rotation_of(const Pose<double>& pose) {
  return {pose.quaternion[0], pose.quaternion[1], pose.quaternion[2], pose.quaternion[3]};
}

Eigen::Vector3d position_of(const Pose<double>& pose) {
  return {pose.position_m[0], pose.position_m[1], pose.position_m[2]};
}

// A tracker some metres away, in any attitude.
Pose<double> random_base(Random& random) {
  Pose<double> pose{};
  store(random_rotation(random), pose.quaternion);
  const Eigen::Vector3d direction = normal_vector(random).normalized();
  const double distance_m = random.uniform(2, 4);
  for (int axis = 0; axis < 3; ++axis) pose.position_m[axis] = distance_m * direction[axis];
  return pose;
}

// Origin and axis of every joint, then the flange's origin, by products of Eigen's transforms.
struct Axes {
  std::vector<Eigen::Vector3d> origin, axis;
};

Axes axes_at(const Geometry& g, const Joints& coordinate) {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY(), z = Eigen::Vector3d::UnitZ();
  Axes out;
  Eigen::Isometry3d at = Eigen::Isometry3d::Identity();
  for (std::size_t i = 0; i < static_cast<std::size_t>(g.joint_count); ++i) {
    const Link& link = g.link[i];
    const bool turns = g.joint[i].kind == JointKind::revolute;
    at = at * Eigen::AngleAxisd(link.alpha_rad, x) * Eigen::Translation3d(link.a_m * x);
    out.axis.push_back(at.linear() * z);
    at = at * Eigen::AngleAxisd(link.theta_rad + (turns ? coordinate[i] : 0.0), z) *
         Eigen::Translation3d((link.d_m + (turns ? 0.0 : coordinate[i])) * z) * Eigen::AngleAxisd(link.beta_rad, y);
    out.origin.push_back(at.translation());
  }
  const double* p = g.last_T_flange.position_m;
  out.origin.push_back(at * Eigen::Vector3d(p[0], p[1], p[2]));
  return out;
}

double length_to_end(const Geometry& g, std::size_t from, std::size_t to) {
  double length = 0.0;
  for (std::size_t j = from + 1; j <= to; ++j) length += std::hypot(g.link[j].a_m, g.link[j].d_m);
  return length;
}

}  // namespace

void add_transmission(Robot& truth, double amplitude_rad, double sag_rad, Random& random) {
  const Geometry& g = truth.geometry;
  const auto count = static_cast<std::size_t>(g.joint_count);
  for (std::size_t i = 0; i < count && amplitude_rad > 0; ++i) {
    if (g.joint[i].kind != JointKind::revolute) continue;
    JointFunction& f = truth.transmission.function[i];
    f.seen_min_rad = -std::numbers::pi;
    f.seen_max_rad = std::numbers::pi;
    f.order_count = 28;
    for (const int order : {1, 2, 10, 18, 28}) {
      const double phase = random.uniform(-std::numbers::pi, std::numbers::pi);
      f.cosine_rad[order - 1] = static_cast<float>(amplitude_rad * std::cos(phase));
      f.sine_rad[order - 1] = static_cast<float>(amplitude_rad * std::sin(phase));
    }
  }
  if (!(sag_rad > 0)) return;
  Gravity& gravity = truth.transmission.gravity;
  std::copy(truth.gravity_direction.begin(), truth.gravity_direction.end(), gravity.direction);
  for (std::size_t i = 0; i < count; ++i) {
    if (g.joint[i].kind != JointKind::revolute) continue;
    double torque = 0.0;
    for (std::size_t j = i; j + 1 < count; ++j) {
      gravity.compliance[i][j] = random.uniform(0.5, 1.5);
      torque += gravity.compliance[i][j] * length_to_end(g, i, j + 1);
    }
    for (double& k : gravity.compliance[i]) k *= torque > 0.0 ? sag_rad / torque : 0.0;
  }
}

Joints turns_of(const Robot& truth, const Joints& q) {
  const Geometry& g = truth.geometry;
  const Transmission& t = truth.transmission;
  const auto count = static_cast<std::size_t>(g.joint_count);
  Joints turn{};
  Joints coordinate{};
  for (std::size_t i = 0; i < count; ++i) {
    coordinate[i] = g.joint[i].sign * q[i];
    for (std::size_t j = 0; j < count; ++j) coordinate[i] += g.joint[i].coupling[j] * q[j];
    for (std::int32_t k = 0; k < t.function[i].order_count; ++k) {
      turn[i] += static_cast<double>(t.function[i].cosine_rad[k]) * std::cos((k + 1) * q[i]) +
                 static_cast<double>(t.function[i].sine_rad[k]) * std::sin((k + 1) * q[i]);
    }
    coordinate[i] += turn[i];
  }
  const Eigen::Vector3d down(t.gravity.direction[0], t.gravity.direction[1], t.gravity.direction[2]);
  if (!(down.norm() > 0)) return turn;
  const Axes at = axes_at(g, coordinate);
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = i; j < count; ++j) {
      turn[i] += t.gravity.compliance[i][j] * at.axis[i].dot((at.origin[j + 1] - at.origin[i]).cross(down));
    }
  }
  return turn;
}

namespace {

// The arm with its joints turned by their functions and their sag at the readings q.
Arm<double> turned_arm(const Robot& truth, const Joints& q) {
  Geometry geometry = truth.geometry;
  const Joints turn = turns_of(truth, q);
  for (std::size_t i = 0; i < static_cast<std::size_t>(geometry.joint_count); ++i) geometry.link[i].theta_rad += turn[i];
  Arm<double> arm{};
  if (make_arm(geometry, arm) != Status::ok) throw InputError("the simulated joint functions take the geometry out of the valid range");
  return arm;
}

// Measures `configurations` random configurations of the true robot.
Dataset measure(const Robot& truth, const Arm<double>& arm, std::size_t configurations,
                const SimulationOptions& options, const std::string& name, Random& random,
                const std::function<void()>& step) {
  Dataset set;
  set.path = name;
  set.joint_count = static_cast<std::size_t>(truth.geometry.joint_count);
  for (const TargetPoint& target : truth.targets) set.targets.push_back(target.name);
  const Pose<double>& base = *truth.tracker_T_base;
  const bool grouped = options.repeats > 1 || options.targets > 1;
  const bool with_terms = options.joint_function_rad > 0 || options.sag_rad > 0;
  std::size_t visit = 0;
  for (std::size_t c = 0; c < configurations; ++c) {
    step();
    const Joints q = random_readings(truth.geometry, random);
    for (std::size_t r = 0; r < options.repeats; ++r) {
      ++visit;
      if (grouped ? r == 0 : true) set.groups.push_back(std::to_string(c + 1));
      auto actual = q;
      for (std::size_t i = 0; i < set.joint_count; ++i) actual[i] += options.joint_noise_rad * random.normal();
      const Arm<double> turned = with_terms ? turned_arm(truth, actual) : arm;
      Pose<double> base_T_flange{};
      if (forward(turned, actual.data(), base_T_flange) != Status::ok) {
        throw InputError("the simulated robot has joint limits beyond the valid range of a reading");
      }
      for (std::size_t t = 0; t < truth.targets.size(); ++t) {
        const Vector3& p = truth.targets[t].flange_p_m;
        const Eigen::Vector3d in_base =
            position_of(base_T_flange) + rotation_of(base_T_flange) * Eigen::Vector3d(p[0], p[1], p[2]);
        const Eigen::Vector3d in_tracker =
            position_of(base) + rotation_of(base) * in_base + options.noise_m * normal_vector(random);
        Measurement row;
        row.id = std::to_string(visit);
        row.group = static_cast<std::uint32_t>(set.groups.size() - 1);
        row.target = static_cast<std::uint32_t>(t);
        row.q = q;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          row.position_m[axis] = in_tracker[static_cast<int>(axis)];
          row.sigma_m[axis] = options.state_sigma ? options.noise_m : 0;
        }
        if (options.full_pose) {
          row.kind = MeasurementKind::pose;
          double quaternion[4];
          store(rotation_of(base) * rotation_of(base_T_flange) *
                    small_rotation(options.rotation_noise_rad * normal_vector(random)),
                quaternion);
          std::copy(std::begin(quaternion), std::end(quaternion), row.quaternion.begin());
          row.rotation_numbers = row.quaternion;
        }
        row.line = static_cast<long>(set.rows.size()) + 2;
        set.rows.push_back(row);
      }
    }
  }
  set.rotation.convention = *rotation_convention("quaternion");
  return set;
}

std::vector<std::size_t> add_outliers(Dataset& set, const SimulationOptions& options, Random& random) {
  const auto count = static_cast<std::size_t>(
      std::lround(options.outlier_fraction * static_cast<double>(set.rows.size())));
  std::vector<std::size_t> rows(set.rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = i;
  for (std::size_t i = 0; i < count; ++i) std::swap(rows[i], rows[i + random.index(rows.size() - i)]);
  rows.resize(count);
  std::sort(rows.begin(), rows.end());
  for (const std::size_t row : rows) {
    const Eigen::Vector3d error = options.outlier_m * normal_vector(random).normalized();
    for (std::size_t axis = 0; axis < 3; ++axis) set.rows[row].position_m[axis] += error[static_cast<int>(axis)];
  }
  return rows;
}

}  // namespace

Simulation simulate(const Robot& robot, const SimulationOptions& options,
                    const std::function<void(std::size_t, std::size_t)>& progress) {
  check_options(options);
  Random random(options.seed);
  Simulation result;
  result.nominal = robot;
  result.nominal.tracker_T_base.reset();
  const auto points = nominal_targets(robot, options.targets);
  result.nominal.tool_p_m = points.front().flange_p_m;
  result.nominal.targets = options.targets > 1 ? points : std::vector<TargetPoint>{};
  std::copy(std::begin(robot.geometry.link), std::end(robot.geometry.link), result.nominal.nominal.begin());

  result.truth = result.nominal;
  add_errors(result.truth.geometry, options, random);
  result.truth.targets = points;
  if (options.joint_function_rad > 0 || options.sag_rad > 0) {
    add_transmission(result.truth, options.joint_function_rad, options.sag_rad, random);
    if (check_transmission(result.truth.geometry, result.truth.transmission) != Status::ok) {
      throw InputError("the joint functions or the sag asked for are beyond what a controller accepts (5 mrad and a slope of 0.1, 20 mrad)");
    }
  }
  for (TargetPoint& target : result.truth.targets) {
    for (double& coordinate : target.flange_p_m) coordinate += options.length_error_m * random.normal();
  }
  Pose<double> identity{};
  identity.quaternion[0] = 1;
  result.truth.tracker_T_base = options.base_frame ? identity : random_base(random);

  Arm<double> arm{};
  if (make_arm(result.truth.geometry, arm) != Status::ok) {
    throw InputError(robot.path, 0, 0, "the simulated errors take the robot's geometry out of the valid range.");
  }
  std::size_t done = 0;
  const auto step = [&] {
    if (progress) progress(done, options.configurations + options.test_configurations);
    ++done;
  };
  result.train = measure(result.truth, arm, options.configurations, options, "measurements.csv", random, step);
  result.test = measure(result.truth, arm, options.test_configurations, options, "test.csv", random, step);
  result.outlier_rows = add_outliers(result.train, options, random);
  return result;
}

}  // namespace mdhcal::offline
