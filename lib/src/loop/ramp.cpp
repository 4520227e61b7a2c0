// SPDX-License-Identifier: MIT
// The ramp of a compensator: parameters as offsets from a goal that fade.
#include "mdhcal/compensator.hpp"

#include <string.h>

#include "number/real.hpp"

#include "arm/chain.hpp"
#include "arm/rotation.hpp"
#include "inverse/goal_valid.hpp"
#include "loop/compensator_valid.hpp"
#include "number/compare.hpp"
#include "number/trigonometry.hpp"

namespace mdhcal {

namespace {

using Parameters = RampParameters<Real>;

constexpr Real half_turn = Real(3.14159265358979323846);

// The quintics and their slopes by s = tick / ticks, in factors of what is left of the way: no difference of nearly equal
// numbers, and the soft double of libgcc for Arm rounds one of numbers 2^33 apart to the wrong side.
Real fall(Real s) {
  const Real left = Real{1} - s;
  return left * left * left * (Real{10} - left * (Real{15} - Real{6} * left));
}
Real fall_slope(Real s) { return Real{-30} * (s * s) * ((Real{1} - s) * (Real{1} - s)); }
Real drift(Real s) {
  const Real left = Real{1} - s;
  return s * (left * left * left) * (Real{1} + Real{3} * s);
}
Real drift_slope(Real s) {
  const Real left = Real{1} - s;
  return left * left * ((Real{1} - Real{3} * s) * (Real{1} + Real{5} * s));
}

// What of offset and rate is left, and how fast it goes [1/tick].
struct Weights {
  Real offset, rate, offset_slope, rate_slope;
};

Weights weights_of(const Compensator<Real>& c) {
  const Real total = static_cast<Real>(c.ticks_total);
  const Real fading = static_cast<Real>(c.ticks_fading);
  const Real s = static_cast<Real>(c.ticks_done) / total;
  const Real f = c.ticks_done < c.ticks_fading ? static_cast<Real>(c.ticks_done) / fading : Real{1};
  return {fall(s), fading * drift(f), fall_slope(s) / total, f < Real{1} ? drift_slope(f) : Real{0}};
}

// Calls f(a, b, c) for each number of three sets of parameters.
template <class F>
void each(const Parameters& a, const Parameters& b, Parameters& c, F f) {
  for (std::size_t i = 0; i < max_joints; ++i) {
    for (int k = 0; k < 5; ++k) f(a.link[i][k], b.link[i][k], c.link[i][k]);
    f(a.min[i], b.min[i], c.min[i]);
    f(a.max[i], b.max[i], c.max[i]);
  }
  f(a.reach_m, b.reach_m, c.reach_m);
  f(a.payload_kg, b.payload_kg, c.payload_kg);
  for (int p = 0; p < 3; ++p) {
    for (int k = 0; k < 4; ++k) f(a.pose[p].quaternion[k], b.pose[p].quaternion[k], c.pose[p].quaternion[k]);
    for (int k = 0; k < 3; ++k) f(a.pose[p].position_m[k], b.pose[p].position_m[k], c.pose[p].position_m[k]);
  }
}

void offset_and_rate(const Compensator<Real>& c, Parameters& offset, Parameters& rate) {
  const Weights w = weights_of(c);
  each(c.offset, c.rate, offset, [&](Real o, Real r, Real& now) { now = w.offset * o + w.rate * r; });
  each(c.offset, c.rate, rate, [&](Real o, Real r, Real& now) { now = w.offset_slope * o + w.rate_slope * r; });
}

// The share of the terms, whose they are, and how fast it goes [1/tick].
struct Share {
  Real value, slope;
  bool before;
};

Share share_of(const Compensator<Real>& c) {
  const Real goal = c.goal_arm.terms_share;
  if (c.ticks_done >= c.ticks_total) return {goal, Real{0}, false};
  const TermsRamp<Real>& terms = c.terms;
  if (c.ticks_done >= terms.ticks) {
    const Real total = static_cast<Real>(c.ticks_total - terms.ticks);
    const Real s = static_cast<Real>(c.ticks_done - terms.ticks) / total;
    return {goal - goal * fall(s), -goal * fall_slope(s) / total, false};
  }
  const Real end = terms.ticks == c.ticks_total ? goal : Real{0};
  const Real total = static_cast<Real>(terms.ticks);
  const Real s = static_cast<Real>(c.ticks_done) / total;
  const Real fading = static_cast<Real>(c.ticks_fading < terms.ticks ? c.ticks_fading : terms.ticks);
  const Real f = static_cast<Real>(c.ticks_done) < fading ? static_cast<Real>(c.ticks_done) / fading : Real{1};
  const Real offset = terms.share - end;
  const Real value = end + offset * fall(s) + terms.rate * fading * drift(f);
  return {value, offset * fall_slope(s) / total + (f < Real{1} ? terms.rate * drift_slope(f) : Real{0}), true};
}

Real difference(Real sine_a, Real cosine_a, Real sine_b, Real cosine_b) {
  return arc_tangent(sine_a * cosine_b - cosine_a * sine_b, cosine_a * cosine_b + sine_a * sine_b);
}

// The goal's three poses: flange, tool, user.
void poses_of(const Arm<Real>& arm, const Frames<Real>& frames, Pose<Real>* pose) {
  to_pose(arm.last_T_flange, pose[0]);
  pose[1] = frames.flange_T_tool;
  pose[2] = frames.base_T_user;
}

// What `from` is beyond `to`, the angles the shorter way; a limit that only one of the two has does not move.
void between(const Arm<Real>& from, const Frames<Real>& from_frames, const Arm<Real>& to, const Frames<Real>& to_frames,
             Parameters& offset) {
  offset = Parameters{};
  for (std::int32_t i = 0; i < to.joint_count; ++i) {
    const ArmLink<Real>& a = from.link[i];
    const ArmLink<Real>& b = to.link[i];
    const std::uint32_t bit = 1U << static_cast<std::uint32_t>(i);
    Real theta = a.theta_rad - b.theta_rad;  // at most four turns, see max_angle_rad
    for (int k = 0; k < 4 && theta > half_turn; ++k) theta -= Real{2} * half_turn;
    for (int k = 0; k < 4 && theta < -half_turn; ++k) theta += Real{2} * half_turn;
    offset.link[i][0] = difference(a.sin_alpha, a.cos_alpha, b.sin_alpha, b.cos_alpha);
    offset.link[i][1] = a.a_m - b.a_m;
    offset.link[i][2] = theta;
    offset.link[i][3] = a.d_m - b.d_m;
    offset.link[i][4] = difference(a.sin_beta, a.cos_beta, b.sin_beta, b.cos_beta);
    if ((from.min_mask & to.min_mask & bit) != 0U) offset.min[i] = from.min[i] - to.min[i];
    if ((from.max_mask & to.max_mask & bit) != 0U) offset.max[i] = from.max[i] - to.max[i];
  }
  offset.reach_m = from.reach_m - to.reach_m;
  offset.payload_kg = from.payload_kg - to.payload_kg;
  Pose<Real> a[3], b[3];
  poses_of(from, from_frames, a);
  poses_of(to, to_frames, b);
  for (int p = 0; p < 3; ++p) {
    const Real* x = a[p].quaternion;
    const Real* y = b[p].quaternion;
    const Real inner = (x[0] * y[0] + x[1] * y[1]) + (x[2] * y[2] + x[3] * y[3]);
    for (int k = 0; k < 4; ++k) offset.pose[p].quaternion[k] = (inner < Real{0} ? -x[k] : x[k]) - y[k];
    for (int k = 0; k < 3; ++k) offset.pose[p].position_m[k] = a[p].position_m[k] - b[p].position_m[k];
  }
}

// A pose that is `offset` beyond the goal; its quaternion stays away from 0, since offset is the shorter way.
Pose<Real> moved(const Pose<Real>& goal, const Pose<Real>& offset) {
  Pose<Real> pose;
  Real square = 0;
  for (int k = 0; k < 4; ++k) {
    pose.quaternion[k] = goal.quaternion[k] + offset.quaternion[k];
    square += pose.quaternion[k] * pose.quaternion[k];
  }
  const Real scale = Real{1} / square_root(square);
  for (Real& c : pose.quaternion) c *= scale;
  for (int k = 0; k < 3; ++k) pose.position_m[k] = goal.position_m[k] + offset.position_m[k];
  return pose;
}

// The velocity of moved(): of the origin and the angular one, in the axes of the frame that the pose is in.
void motion_of(const Pose<Real>& goal, const Pose<Real>& offset, const Pose<Real>& rate, Real* motion) {
  Real p[4], square = 0;
  for (int k = 0; k < 4; ++k) {
    p[k] = goal.quaternion[k] + offset.quaternion[k];
    square += p[k] * p[k];
  }
  // omega = 2 vec(p' conj(p)) / |p|^2: the part of p' along p does not turn.
  const Real* d = rate.quaternion;
  const Real scale = Real{2} / square;
  for (int k = 0; k < 3; ++k) motion[k] = rate.position_m[k];
  motion[3] = scale * ((d[1] * p[0] - d[0] * p[1]) + (d[3] * p[2] - d[2] * p[3]));
  motion[4] = scale * ((d[2] * p[0] - d[0] * p[2]) + (d[1] * p[3] - d[3] * p[1]));
  motion[5] = scale * ((d[3] * p[0] - d[0] * p[3]) + (d[2] * p[1] - d[1] * p[2]));
}

// How the joint coordinates go with share [1/tick] and payload [kg/tick]: they are linear in both.
void motion_of_terms(const Arm<Real>& arm, const Real* q, Real share_slope, Real payload_slope, Real* rate) {
  Arm<Real> whole = arm;
  Real terms[max_joints], heavier[max_joints];
  whole.terms_share = 1;
  coordinates_by_terms(whole, q, terms);
  whole.payload_kg += Real{1};
  coordinates_by_terms(whole, q, heavier);
  for (std::int32_t i = 0; i < arm.joint_count; ++i) {
    rate[i] = share_slope * terms[i] + arm.terms_share * payload_slope * (heavier[i] - terms[i]);
  }
}

void turn(Real angle, Real& sine, Real& cosine) {
  Real s = 0, c = 1;
  sin_cos(angle, s, c);
  const Real old = sine;
  sine = old * c + cosine * s;
  cosine = cosine * c - old * s;
}

bool is_identity(const Pose<Real>& pose) {
  Real away = magnitude(pose.quaternion[1]) + magnitude(pose.quaternion[2]) + magnitude(pose.quaternion[3]);
  for (const Real x : pose.position_m) away += magnitude(x);
  return !(away > Real{0});
}

// Puts arm and frames where the ramp has come to.
void place(Compensator<Real>& c) {
  c.arm = c.goal_arm;
  c.frames = c.goal_frames;
  if (c.ticks_done < c.ticks_total) {
    Parameters offset, rate;
    offset_and_rate(c, offset, rate);
    for (std::int32_t i = 0; i < c.arm.joint_count; ++i) {
      ArmLink<Real>& link = c.arm.link[i];
      turn(offset.link[i][0], link.sin_alpha, link.cos_alpha);
      link.a_m += offset.link[i][1];
      link.theta_rad += offset.link[i][2];
      link.d_m += offset.link[i][3];
      turn(offset.link[i][4], link.sin_beta, link.cos_beta);
      c.arm.min[i] += offset.min[i];
      c.arm.max[i] += offset.max[i];
    }
    c.arm.reach_m += offset.reach_m;
    c.arm.payload_kg += offset.payload_kg;
    const Share share = share_of(c);
    if (share.before) c.arm.terms = c.terms.before;
    c.arm.terms_share = share.value;
    c.arm.has_terms = magnitude(share.value) > Real{0} ? 1 : 0;
    Pose<Real> pose[3];
    poses_of(c.goal_arm, c.goal_frames, pose);
    to_frame(moved(pose[0], offset.pose[0]), c.arm.last_T_flange);
    c.arm.has_flange = 1;
    c.frames.flange_T_tool = moved(pose[1], offset.pose[1]);
    c.frames.base_T_user = moved(pose[2], offset.pose[2]);
  }
  c.has_frames = is_identity(c.frames.base_T_user) && is_identity(c.frames.flange_T_tool) ? 0 : 1;
  if (c.has_frames == 0) return;
  Frame<Real> tool;
  to_frame(c.frames.flange_T_tool, tool);
  multiply(c.arm.last_T_flange, tool, c.arm.last_T_flange);
  c.arm.has_flange = 1;
  for (const Real p : tool.position_m) c.arm.reach_m += magnitude(p);
}

bool same_terms(const ArmTerms<Real>& a, const ArmTerms<Real>& b) {
  return a.functions == b.functions && memcmp(a.compliance, b.compliance, sizeof a.compliance) == 0 &&
         memcmp(a.across, b.across, sizeof a.across) == 0 &&
         memcmp(a.payload_compliance, b.payload_compliance, sizeof a.payload_compliance) == 0 &&
         memcmp(a.payload_p_m, b.payload_p_m, sizeof a.payload_p_m) == 0 &&
         memcmp(a.flange_p_m, b.flange_p_m, sizeof a.flange_p_m) == 0 && !(a.payload_kg < b.payload_kg) &&
         !(a.payload_kg > b.payload_kg);
}

// Where the terms are, as a ramp begins that leads to `goal`.
void begin_terms(Compensator<Real>& c, const Arm<Real>& goal, std::uint32_t ticks) {
  TermsRamp<Real>& terms = c.terms;
  const Share share = share_of(c);
  terms.has_before = c.arm.has_terms;
  terms.ticks = 0;
  if (terms.has_before == 0) return;
  terms.before = c.arm.terms;
  terms.share = share.value;
  terms.rate = share.slope;
  terms.ticks = goal.has_terms == 0 || same_terms(c.arm.terms, goal.terms) ? ticks : ticks / 2U;
}

void begin(Compensator<Real>& c, const Arm<Real>& arm, const Frames<Real>& frames, std::uint32_t ticks) {
  begin_terms(c, arm, ticks);
  Parameters moved_by{}, offset{}, rate{};
  const std::uint32_t left = ramp_ticks_left(c);
  if (left > 0U) {
    offset_and_rate(c, offset, rate);
    // Quaternions go on from their normalised place and velocity.
    Pose<Real> pose[3];
    poses_of(c.goal_arm, c.goal_frames, pose);
    for (int p = 0; p < 3; ++p) {
      Real size = 0, along = 0;
      const Pose<Real> here = moved(pose[p], offset.pose[p]);
      for (int k = 0; k < 4; ++k) {
        const Real sum = pose[p].quaternion[k] + offset.pose[p].quaternion[k];
        size += sum * sum;
        along += here.quaternion[k] * rate.pose[p].quaternion[k];
      }
      size = square_root(size);
      for (int k = 0; k < 4; ++k) {
        rate.pose[p].quaternion[k] = (rate.pose[p].quaternion[k] - along * here.quaternion[k]) / size;
        offset.pose[p].quaternion[k] = here.quaternion[k] - pose[p].quaternion[k];
      }
    }
  }
  between(c.goal_arm, c.goal_frames, arm, frames, moved_by);
  Pose<Real> old_goal[3], new_goal[3];
  poses_of(c.goal_arm, c.goal_frames, old_goal);
  poses_of(arm, frames, new_goal);
  const Parameters before = offset;
  each(before, moved_by, offset, [](Real a, Real b, Real& sum) { sum = a + b; });
  for (int p = 0; p < 3; ++p) {
    // q and -q are one rotation: from the present place to the goal the shorter way.
    Real here[4], inner = 0;
    for (int k = 0; k < 4; ++k) {
      here[k] = old_goal[p].quaternion[k] + before.pose[p].quaternion[k];
      inner += here[k] * new_goal[p].quaternion[k];
    }
    const Real sign = inner < Real{0} ? Real{-1} : Real{1};
    for (int k = 0; k < 4; ++k) {
      offset.pose[p].quaternion[k] = sign * here[k] - new_goal[p].quaternion[k];
      rate.pose[p].quaternion[k] *= sign;
    }
  }
  c.goal_arm = arm;
  c.goal_frames = frames;
  c.offset = offset;
  c.rate = rate;
  c.ticks_done = 0;
  c.ticks_total = ticks;
  c.ticks_fading = left < ticks ? left : ticks;
  if (ticks == 0U) place(c);
}

bool same_joints(const Arm<Real>& a, const Arm<Real>& b) {
  if (a.joint_count != b.joint_count || a.prismatic_mask != b.prismatic_mask) return false;
  for (std::int32_t i = 0; i < a.joint_count; ++i) {
    for (std::int32_t j = 0; j < a.joint_count; ++j) {
      if (magnitude(a.map[i][j] - b.map[i][j]) > Real{0}) return false;
    }
  }
  return true;
}

bool made(const CalibratedArm<Real>& arm, Model model) {
  return arm.nominal.mark == arm_mark<Real> && arm.corrected.mark == arm_mark<Real> &&
         (model == Model::nominal || model == Model::corrected);
}

}  // namespace

Status start_at_rest(const CalibratedArm<Real>& arm, Model model, Compensator<Real>& compensator) noexcept {
  if (!made(arm, model)) return Status::bad_input;
  compensator = Compensator<Real>{};
  compensator.mark = compensator_mark;
  compensator.nominal = arm.nominal;
  compensator.goal_arm = model == Model::corrected ? arm.corrected : arm.nominal;
  compensator.goal_frames = identity_frames<Real>();
  place(compensator);
  return Status::ok;
}

Status start_ramp(Compensator<Real>& compensator, const CalibratedArm<Real>& arm, Model model,
                  std::uint32_t ticks) noexcept {
  if (!valid(compensator) || !made(arm, model) || !same_joints(arm.corrected, compensator.goal_arm)) {
    return Status::bad_input;
  }
  Arm<Real> goal = model == Model::corrected ? arm.corrected : arm.nominal;
  // A payload that the new model may not carry, or knows nothing of, leaves it with the calibration's.
  if (compensator.has_payload != 0 && set_payload(goal, compensator.payload_kg) != Status::ok) goal.payload_kg = goal.terms.payload_kg;
  // What has no terms knows of no payload: there it stays what it is, or becomes at once what it will be.
  if (goal.has_terms == 0) goal.payload_kg = compensator.goal_arm.payload_kg;
  if (compensator.arm.has_terms == 0) compensator.goal_arm.payload_kg = goal.payload_kg;
  begin(compensator, goal, compensator.goal_frames, ticks);
  return Status::ok;
}

Status start_payload_ramp(Compensator<Real>& compensator, Real payload_kg, std::uint32_t ticks) noexcept {
  if (!valid(compensator)) return Status::bad_input;
  Arm<Real> goal = compensator.goal_arm;
  if (set_payload(goal, payload_kg) != Status::ok) return Status::bad_input;
  compensator.payload_kg = payload_kg;
  compensator.has_payload = 1;
  begin(compensator, goal, compensator.goal_frames, ticks);
  return Status::ok;
}

Status start_frame_ramp(Compensator<Real>& compensator, const Frames<Real>& frames, std::uint32_t ticks) noexcept {
  if (!valid(compensator) || !target_valid(frames.base_T_user) || !target_valid(frames.flange_T_tool)) {
    return Status::bad_input;
  }
  const Arm<Real> arm = compensator.goal_arm;
  begin(compensator, arm, frames, ticks);
  return Status::ok;
}

Status advance_ramp(Compensator<Real>& compensator) noexcept {
  if (!valid(compensator)) return Status::bad_input;
  if (compensator.ticks_done < compensator.ticks_total) {
    ++compensator.ticks_done;
    place(compensator);
  }
  return Status::ok;
}

Status ramp_motion(const Compensator<Real>& compensator, const Real* q, Real* motion) noexcept {
  if (!valid(compensator)) return Status::bad_input;
  const Arm<Real>& arm = compensator.arm;
  Frame<Real> frames[max_joints + 2];
  const Status status = link_frames(arm, q, frames);
  if (status != Status::ok) return status;
  for (int k = 0; k < 6; ++k) motion[k] = 0;
  if (ramp_ticks_left(compensator) == 0U) return Status::ok;
  Parameters offset, rate;
  offset_and_rate(compensator, offset, rate);
  const Frame<Real>& tool = frames[arm.joint_count + 1];
  // A turn about `axis` through the origin of `frame`, and a shift along it.
  const auto add = [&](const Real* axis, const Frame<Real>& frame, Real angle, Real shift) {
    Real lever[3];
    for (int k = 0; k < 3; ++k) {
      lever[k] = tool.position_m[k] - frame.position_m[k];
      motion[k] += shift * axis[k];
      motion[3 + k] += angle * axis[k];
    }
    add_cross(axis, lever, angle, motion);
  };
  for (std::int32_t i = 0; i < arm.joint_count; ++i) {
    const ArmLink<Real>& link = arm.link[i];
    const Real* before = frames[i].rotation;
    const Real* after = frames[i + 1].rotation;
    Real x[3], y[3], z[3];
    for (int k = 0; k < 3; ++k) {
      x[k] = before[3 * k];
      y[k] = after[3 * k + 1];
      z[k] = link.cos_beta * after[3 * k + 2] - link.sin_beta * after[3 * k];  // before Rot_y(beta)
    }
    add(x, frames[i], rate.link[i][0], rate.link[i][1]);
    add(z, frames[i + 1], rate.link[i][2], rate.link[i][3]);
    add(y, frames[i + 1], rate.link[i][4], Real{0});
  }
  if (arm.has_terms != 0) {
    Real moved_by[max_joints];
    motion_of_terms(arm, q, share_of(compensator).slope, rate.payload_kg, moved_by);
    for (std::int32_t i = 0; i < arm.joint_count; ++i) {
      const ArmLink<Real>& link = arm.link[i];
      const Real* after = frames[i + 1].rotation;
      Real z[3];
      for (int k = 0; k < 3; ++k) z[k] = link.cos_beta * after[3 * k + 2] - link.sin_beta * after[3 * k];
      add(z, frames[i + 1], moved_by[i], Real{0});
    }
  }
  // Flange and tool move in the frames before them; the flange's own frame is the tool's with the tool taken off.
  Pose<Real> goal[3];
  poses_of(compensator.goal_arm, compensator.goal_frames, goal);
  Frame<Real> own, flange;
  to_frame(moved(goal[0], offset.pose[0]), own);
  multiply(frames[arm.joint_count], own, flange);
  const Frame<Real>* outer[2] = {&frames[arm.joint_count], &flange};
  for (int p = 0; p < 2; ++p) {
    Real local[6], turned[6];
    motion_of(goal[p], offset.pose[p], rate.pose[p], local);
    for (int k = 0; k < 3; ++k) {
      turned[k] = dot(outer[p]->rotation + 3 * k, local);
      turned[3 + k] = dot(outer[p]->rotation + 3 * k, local + 3);
    }
    const Frame<Real>& moving = p == 0 ? flange : tool;
    Real lever[3];
    for (int k = 0; k < 3; ++k) {
      lever[k] = tool.position_m[k] - moving.position_m[k];
      motion[k] += turned[k];
      motion[3 + k] += turned[3 + k];
    }
    add_cross(turned + 3, lever, Real{1}, motion);
  }
  // The target moves with the user frame.
  Real user[6], lever[3];
  motion_of(goal[2], offset.pose[2], rate.pose[2], user);
  for (int k = 0; k < 3; ++k) lever[k] = tool.position_m[k] - compensator.frames.base_T_user.position_m[k];
  for (int k = 0; k < 6; ++k) motion[k] -= user[k];
  add_cross(user + 3, lever, Real{-1}, motion);
  return Status::ok;
}

}  // namespace mdhcal
