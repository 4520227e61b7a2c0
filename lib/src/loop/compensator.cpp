// SPDX-License-Identifier: MIT
#include "mdhcal/compensator.hpp"

#include "number/real.hpp"

#include "arm/chain.hpp"
#include "arm/rotation.hpp"
#include "inverse/goal_valid.hpp"
#include "inverse/pose_error.hpp"
#include "loop/compensator_valid.hpp"
#include "number/compare.hpp"

namespace mdhcal {

namespace {

// Pose of the tool on the nominal arm in the base frame.
Status nominal_tool(const Compensator<Real>& c, const Real* q, Pose<Real>& base_T_tool) {
  const Status status = forward(c.nominal, q, base_T_tool);
  if (status != Status::ok || c.has_frames == 0) return status;
  return multiply(base_T_tool, c.frames.flange_T_tool, base_T_tool);
}

// Whether a full turn of the reading changes nothing but the reading.
bool turns_freely(const Arm<Real>& arm, std::int32_t j) {
  if (((arm.prismatic_mask >> static_cast<std::uint32_t>(j)) & 1U) != 0U) return false;
  for (std::int32_t i = 0; i < arm.joint_count; ++i) {
    if (i != j && magnitude(arm.map[i][j]) > Real{0}) return false;
  }
  return true;
}

// The reading counted in the turn that is nearest to `near`.
Real rebased(Real reading, Real near) {
  constexpr Real full_turn = Real(6.28318530717958647693);
  const Real turns = (near - reading) / full_turn;
  return reading + full_turn * static_cast<Real>(static_cast<std::int32_t>(turns < Real{0} ? turns - Real(0.5) : turns + Real(0.5)));
}

// From `last` towards q*, which becomes the result, each joint as far as its step limit. Returns the joints that it stopped.
std::uint32_t limit_steps(const StepLimits<Real>& limits, std::int32_t joints, const Real* last, Real* q) {
  constexpr Real epsilon = sizeof(Real) == sizeof(double) ? Real(2.3e-16) : Real(1.2e-7);
  std::uint32_t mask = 0;
  for (std::int32_t j = 0; j < joints; ++j) {
    if (!(magnitude(q[j] - last[j]) > limits.max_step[j])) continue;
    // The rounding of last + step must not add to the step.
    const Real reach = limits.max_step[j] - epsilon * (magnitude(last[j]) + limits.max_step[j]);
    q[j] = reach > Real{0} ? clamp(last[j] - reach, q[j], last[j] + reach) : last[j];
    mask |= 1U << static_cast<std::uint32_t>(j);
  }
  return mask;
}

}  // namespace

Status pose_to_joints(const Compensator<Real>& compensator, const TickOptions<Real>& options,
                      const Pose<Real>& user_T_tool, Real* q, TickReport<Real>* report) noexcept {
  if (!valid(compensator) || !target_valid(user_T_tool)) return Status::bad_input;
  if (compensator.has_frames == 0) return tick(compensator.arm, options, user_T_tool, q, report);
  Pose<Real> base_T_tool;
  const Status status = multiply(compensator.frames.base_T_user, user_T_tool, base_T_tool);
  return status == Status::ok ? tick(compensator.arm, options, base_T_tool, q, report) : status;
}

Status joints_to_joints(const Compensator<Real>& compensator, const TickOptions<Real>& options, const Real* nominal_q,
                        Real* q, TickReport<Real>* report) noexcept {
  if (!valid(compensator)) return Status::bad_input;
  const Arm<Real>& arm = compensator.arm;
  const std::int32_t joints = arm.joint_count;
  Pose<Real> meant;
  Status status = nominal_tool(compensator, nominal_q, meant);
  if (status != Status::ok || !readings_valid(arm, q)) return Status::bad_input;
  for (std::int32_t j = 0; j < joints; ++j) {
    if (!within(Real{0}, options.limits.max_step[j], Real(1e6)) || !(options.limits.max_step[j] > Real{0})) {
      return Status::bad_input;
    }
  }
  // What belongs to the nominal joints is sought from them, without a step limit: their branch, their turn.
  TickOptions<Real> from_nominal = options;
  for (Real& step : from_nominal.limits.max_step) step = static_cast<Real>(max_reading);
  Real last[max_joints], found[max_joints];
  for (std::int32_t j = 0; j < joints; ++j) {
    last[j] = turns_freely(arm, j) ? rebased(q[j], nominal_q[j]) : q[j];
    found[j] = nominal_q[j];
  }
  TickReport<Real> done{};
  status = tick(arm, from_nominal, meant, found, &done);
  if (status == Status::bad_input) return status;
  const std::uint32_t stopped = limit_steps(options.limits, joints, last, found);
  if (stopped != 0U) {
    Frame<Real> target, frame;
    PoseError error;
    to_frame(meant, target);
    evaluate(arm, found, frame);
    pose_error(target, frame, options.goal.task, error);
    done.position_error_m = error.position_m;
    done.rotation_error_rad = error.rotation_rad;
    done.iterations += 1;
    const bool met = error.position_m <= options.goal.position_tolerance_m &&
                     error.rotation_rad <= options.goal.rotation_tolerance_rad;
    status = met ? Status::ok : Status::step_limited;
  }
  done.step_mask = stopped;
  for (std::int32_t j = 0; j < joints; ++j) q[j] = found[j];
  if (report != nullptr) *report = done;
  return status;
}

Status pose_to_pose(const Compensator<Real>& compensator, const TickOptions<Real>& options, const Pose<Real>& user_T_tool,
                    Real* q, Pose<Real>& command, TickReport<Real>* report) noexcept {
  const Status status = pose_to_joints(compensator, options, user_T_tool, q, report);
  if (status == Status::bad_input) return status;
  Pose<Real> nominal;
  Status reached = nominal_tool(compensator, q, nominal);
  if (reached == Status::ok && compensator.has_frames != 0) {
    Pose<Real> user_T_base;
    reached = invert(compensator.frames.base_T_user, user_T_base);
    if (reached == Status::ok) reached = multiply(user_T_base, nominal, nominal);
  }
  if (reached != Status::ok) return reached;
  command = nominal;
  return status;
}

Status joint_velocities(const Compensator<Real>& compensator, const Real* q, const Real* tool_velocity, Real period_s,
                        const JointRateLimits<Real>& limits, Real* velocity) noexcept {
  if (!within(Real{0}, period_s, Real(1e3)) || !(period_s > Real(1e-9))) return Status::bad_input;
  Real wanted[6];
  const Status status = ramp_motion(compensator, q, wanted);
  if (status != Status::ok) return status;
  for (int k = 0; k < 6; ++k) wanted[k] /= -period_s;
  if (compensator.has_frames == 0) {
    for (int k = 0; k < 6; ++k) wanted[k] += tool_velocity[k];
  } else {
    Frame<Real> user;
    to_frame(compensator.frames.base_T_user, user);
    for (int k = 0; k < 3; ++k) {
      wanted[k] += dot(user.rotation + 3 * k, tool_velocity);
      wanted[3 + k] += dot(user.rotation + 3 * k, tool_velocity + 3);
    }
  }
  return joint_velocities(compensator.arm, q, wanted, limits, velocity);
}

}  // namespace mdhcal
