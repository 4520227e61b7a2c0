// SPDX-License-Identifier: MIT
#include "offline/filter/posture.hpp"

#include <algorithm>
#include <cmath>

#include "mdhcal/kinematics.hpp"
#include "offline/robot/vectors.hpp"

namespace mdhcal::offline {

namespace {

// Two solutions of a pose differ by tens of degrees, and the rounding of a program's numbers moves a joint by thousandths: one degree
// tells the one from the other.
constexpr double nearest_rad = one_degree_rad;

double outside(const ReadingRange& range, double q) { return std::max({0.0, range.least - q, q - range.most}); }

double way_between(const Joints& a, const Joints& b) {
  double sum = 0;
  for (std::size_t j = 0; j < max_joints; ++j) sum += (a[j] - b[j]) * (a[j] - b[j]);
  return std::sqrt(sum);
}

// Whether the branch that the joints were on is the one to stay on, without asking whether there is a nearer one: that would lie
// within twice this way, and two solutions so near to each other are next to a singularity, which a move does not pass by itself.
bool near_by(const Joints& a, const Joints& b) { return way_between(a, b) < 10 * one_degree_rad; }

// Whether shoulder, elbow and wrist are all stated, the first and the last perhaps by the turns of axes 1 and 4, which the other side
// would leave by half a turn.
bool complete(const Configuration& stated) {
  const auto bounded = [&](std::size_t j) { return stated.reading[j].most - stated.reading[j].least < one_turn_rad / 2; };
  const bool wrist = stated.reading[4].least > -unbounded || stated.reading[4].most < unbounded || bounded(3);
  return stated.lower && (stated.rear || bounded(0)) && wrist;
}

// The arm of the first links, of joint coordinates instead of readings.
Arm<double> begin_of_arm(Geometry geometry, std::int32_t count) {
  for (std::size_t k = 0; k < max_joints; ++k) {
    Joint& joint = geometry.joint[k];
    const JointKind kind = joint.kind;
    joint = Joint{};
    joint.kind = kind;
    joint.sign = static_cast<std::int32_t>(k) < count ? 1 : 0;
    if (static_cast<std::int32_t>(k) >= count) {
      geometry.link[k] = Link{};
      joint.kind = JointKind::revolute;
    }
  }
  geometry.joint_count = count;
  geometry.last_T_flange = Pose<double>{{1, 0, 0, 0}, {0, 0, 0}};
  Arm<double> arm{};
  (void)make_arm(geometry, arm);  // its links are those of a valid geometry
  return arm;
}

Vector3 axis_of(const Frame<double>& frame, std::size_t k) { return {frame.rotation[k], frame.rotation[3 + k], frame.rotation[6 + k]}; }
Vector3 origin_of(const Frame<double>& frame) { return {frame.position_m[0], frame.position_m[1], frame.position_m[2]}; }

}  // namespace

Postures::Postures(const Geometry& nominal) {
  (void)make_arm(nominal, arm_);
  spherical_ = family_of(arm_) == ArmFamily::spherical_wrist;
  if (!spherical_) return;
  constexpr std::int32_t counts[4] = {1, 2, 3, 5};
  for (std::size_t k = 0; k < 4; ++k) begin_[k] = begin_of_arm(nominal, counts[k]);
  // Zero readings themselves may be a straight arm, which has no sides: 0.1 rad lies well clear of that, and short of any other fold.
  const Sides reference = sides(Joints{0, 0.1, 0.1});
  front_sign_ = reference.front_m < 0 ? -1 : 1;
  above_sign_ = reference.above_m2 * front_sign_ < 0 ? -1 : 1;
}

// Signed by the directions of the axes: the signs at a reference say which side is which.
Postures::Sides Postures::sides(const Joints& q) const {
  Joints coordinate{};
  for (std::int32_t i = 0; i < arm_.joint_count; ++i) {
    for (std::int32_t j = 0; j < arm_.joint_count; ++j) coordinate[static_cast<std::size_t>(i)] += arm_.map[i][j] * q[static_cast<std::size_t>(j)];
  }
  Frame<double> frame[4];
  for (std::size_t k = 0; k < 4; ++k) {
    Pose<double> pose{};
    if (forward(begin_[k], coordinate.data(), pose) != Status::ok) return {0, 0};
    frame[k] = frame_of(pose);
  }
  const Vector3 up = axis_of(frame[0], 2);
  const Vector3 front = cross(axis_of(frame[1], 2), up);
  const Vector3 wrist = minus(origin_of(frame[3]), origin_of(frame[1]));
  const Vector3 elbow = minus(origin_of(frame[2]), origin_of(frame[1]));
  return {dot(front, minus(origin_of(frame[3]), origin_of(frame[0]))), dot(front, wrist) * dot(up, elbow) - dot(up, wrist) * dot(front, elbow)};
}

double Postures::distance(const Configuration& stated, const Joints& q) const {
  double sum = 0;
  for (std::size_t j = 0; j < static_cast<std::size_t>(arm_.joint_count); ++j) sum += outside(stated.reading[j], q[j]);
  if (spherical_ && (stated.rear || stated.lower)) {
    const Sides at = sides(q);
    if (stated.rear && *stated.rear != (at.front_m * front_sign_ < 0)) sum += 1;
    if (stated.lower && *stated.lower != (at.above_m2 * front_sign_ * above_sign_ < 0)) sum += 1;
  }
  return sum;
}

Solved Postures::solve(const Pose<double>& base_T_flange, const Configuration& stated, const Joints& before) const {
  const Solved near = solve_from(arm_, base_T_flange, before);
  if (near.status == Status::bad_input) return near;
  if (near.status == Status::ok && (complete(stated) || near_by(near.q, before)) && distance(stated, near.q) < nearest_rad) return near;
  Solutions<double> found{};
  const Status status = find_solutions(arm_, default_solution_options(arm_), base_T_flange, before.data(), found);
  if (status != Status::ok) return {near.q, near.status == Status::ok ? Status::not_converged : near.status};
  Solved best{near.q, Status::not_converged};
  double nearest = nearest_rad, way = unbounded;
  for (std::int32_t k = 0; k < found.count; ++k) {
    Joints q{};
    std::copy(std::begin(found.q[k]), std::end(found.q[k]), q.begin());
    for (std::size_t j = 0; j < static_cast<std::size_t>(arm_.joint_count); ++j) {
      if (((arm_.prismatic_mask >> j) & 1U) != 0U) continue;
      for (int turn = -2; turn <= 2; ++turn) {
        const double other = found.q[k][j] + turn * one_turn_rad;
        if (((arm_.min_mask >> j) & 1U) != 0U && other < arm_.min[j]) continue;
        if (((arm_.max_mask >> j) & 1U) != 0U && other > arm_.max[j]) continue;
        if (outside(stated.reading[j], other) < outside(stated.reading[j], q[j])) q[j] = other;
      }
    }
    const double away = distance(stated, q);
    // What fits better by more than a rounding; of what fits alike, the nearer one.
    const double from_before = way_between(q, before);
    const double rounding = 1e-3 * nearest_rad;
    if (!(away < nearest_rad) || away > nearest + rounding || (away > nearest - rounding && from_before >= way)) continue;
    nearest = away;
    way = from_before;
    best = {q, Status::ok};
  }
  return best;
}

}  // namespace mdhcal::offline
