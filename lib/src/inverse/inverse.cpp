// SPDX-License-Identifier: MIT
#include "mdhcal/inverse.hpp"

#include "number/real.hpp"
// The tick's parts see Real.
#include "inverse/constrained_tick.hpp"
#include "inverse/goal_valid.hpp"
#include "number/compare.hpp"

namespace mdhcal {

namespace {

constexpr Real largest = static_cast<Real>(max_reading);

bool positive(Real x) { return within(Real{0}, x, Real(1e6)) && x > Real{0}; }

bool valid(const TickOptions<Real>& options, std::int32_t joints) {
  if (!goal_valid(options.goal)) return false;
  if (options.max_iterations < 1 || options.max_iterations > max_tick_iterations) return false;
  if (!within(Real{0}, options.posture.gain, Real{1})) return false;
  for (std::int32_t j = 0; j < joints; ++j) {
    if (!positive(options.limits.max_step[j])) return false;
    if (options.posture.gain > Real{0} && !within(-largest, options.posture.q[j], largest)) return false;
  }
  return true;
}

// The limits of joint j; outside them it only moves inwards.
void set_limits(TickState& state, std::int32_t j, Real q) {
  const Arm<Real>& arm = *state.arm;
  const std::uint32_t bit = 1U << static_cast<std::uint32_t>(j);
  const Real min = (arm.min_mask & bit) != 0U ? arm.min[j] : -largest;
  const Real max = (arm.max_mask & bit) != 0U ? arm.max[j] : largest;
  state.low[j] = q < min ? q : min;
  state.high[j] = q > max ? q : max;
}

std::uint32_t outside_limits(const Arm<Real>& arm, const Real* q) {
  std::uint32_t mask = 0;
  for (std::int32_t j = 0; j < arm.joint_count; ++j) {
    const std::uint32_t bit = 1U << static_cast<std::uint32_t>(j);
    if ((arm.min_mask & bit) != 0U && q[j] < arm.min[j]) mask |= bit;
    if ((arm.max_mask & bit) != 0U && q[j] > arm.max[j]) mask |= bit;
  }
  return mask;
}

}  // namespace

bool goal_valid(const GoalOptions<Real>& goal) noexcept {
  if (!positive(goal.position_tolerance_m) || !positive(goal.rotation_tolerance_rad)) return false;
  if (!positive(goal.position_weight) || !positive(goal.rotation_weight)) return false;
  return goal.task == Task::pose || goal.task == Task::position || goal.task == Task::position_axis ||
         goal.task == Task::planar;
}

bool target_valid(const Pose<Real>& target) noexcept {
  constexpr Real tolerance = sizeof(Real) == sizeof(double) ? Real(1e-6) : Real(1e-5);
  const Real* c = target.quaternion;
  for (int k = 0; k < 4; ++k) {
    if (!within(Real{-2}, c[k], Real{2})) return false;
  }
  const Real square = (c[0] * c[0] + c[1] * c[1]) + (c[2] * c[2] + c[3] * c[3]);
  if (!(magnitude(square - Real{1}) <= Real{2} * tolerance)) return false;
  constexpr Real furthest = static_cast<Real>(max_target_m);
  for (int k = 0; k < 3; ++k) {
    if (!within(-furthest, target.position_m[k], furthest)) return false;
  }
  return true;
}

TickOptions<Real> default_tick_options(const Arm<Real>&) noexcept {
  TickOptions<Real> options{};
  options.goal.position_tolerance_m = sizeof(Real) == sizeof(double) ? Real(1e-10) : Real(5e-6);
  options.goal.rotation_tolerance_rad = options.goal.position_tolerance_m;
  for (Real& step : options.limits.max_step) step = largest;
  options.goal.position_weight = 1;
  options.goal.rotation_weight = Real(0.001);
  options.max_iterations = 4;
  options.goal.task = Task::pose;
  return options;
}

Status tick(const Arm<Real>& arm, const TickOptions<Real>& options, const Pose<Real>& base_T_flange, Real* q,
            TickReport<Real>* report, const Real* branch) noexcept {
  if (!readings_valid(arm, q) || !valid(options, arm.joint_count) || !target_valid(base_T_flange)) return Status::bad_input;
  if (branch != nullptr && !readings_valid(arm, branch)) return Status::bad_input;
  TickState state;
  state.arm = &arm;
  state.options = &options.goal;
  state.tick = &options;
  to_frame(base_T_flange, state.target);
  state.length_m = length_unit(arm);
  state.last = q;
  state.from = branch != nullptr ? branch : q;
  for (std::int32_t j = 0; j < arm.joint_count; ++j) {
    set_limits(state, j, q[j]);
    state.q[j] = within_limits(state, j, state.from[j]);
  }
  state.evaluations = 0;
  state.step_mask = 0;
  state.limit_mask = 0;
  state.smallest_singular_value = 1;  // until something is known of it
  Status status = solve_tick(state);
  for (std::int32_t j = 0; j < arm.joint_count; ++j) q[j] = state.q[j];
  const std::uint32_t outside = outside_limits(arm, q);
  if (outside != 0U) status = Status::joint_limited;
  if (report != nullptr) {
    report->position_error_m = state.error.position_m;
    report->rotation_error_rad = state.error.rotation_rad;
    report->smallest_singular_value = state.smallest_singular_value;
    report->iterations = state.evaluations;
    report->step_mask = state.step_mask;
    report->limit_mask = state.limit_mask | outside;
    report->unseen_mask = unseen_readings(arm, q);
  }
  return status;
}

}  // namespace mdhcal
