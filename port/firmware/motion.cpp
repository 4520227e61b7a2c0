// SPDX-License-Identifier: MIT
#include "motion.hpp"

#include <cmath>

namespace firmware {

namespace {

using mdhcal::Status;

// A slow swing of every joint about a posture away from the arm's singularities.
void path(std::uint32_t tick, double* q) {
  constexpr double centre_rad[joint_count] = {0.3, -1.2, 1.4, -0.9, 1.1, 0.2};
  constexpr double swing_rad = 0.15;
  constexpr double turn_rad = 6.283185307179586;
  constexpr std::uint32_t period = 4000;
  for (std::int32_t i = 0; i < joint_count; ++i) {
    const double phase = turn_rad * static_cast<double>(tick % period) / static_cast<double>(period);
    q[i] = centre_rad[i] + swing_rad * std::sin(phase * static_cast<double>(1 + i % 2));
  }
}

// 0 ... 1 with speed and acceleration zero at both ends.
double smooth(double s) { return s * s * s * (10.0 + s * (6.0 * s - 15.0)); }

// The joints that bring the arm as it is to where the path's joints were meant to bring it.
Status correct(const Correction& correction, const double* path_q, double* q) {
  return mdhcal::joints_to_joints(correction.compensator, correction.options, path_q, q);
}

void copy(const double* from, double* to) {
  for (std::int32_t i = 0; i < joint_count; ++i) to[i] = from[i];
}

}  // namespace

bool Motion::begin_swap(const Correction& next) {
  copy(report_.path_q, next_q_);
  if (correct(next, report_.path_q, next_q_) != Status::ok) return false;
  for (std::int32_t i = 0; i < joint_count; ++i) {
    refused_joint_ = i;
    if (!(std::fabs(next_q_[i] - report_.command_q[i]) <= max_jump)) return false;
  }
  next_ = &next;
  ramp_ = 0;
  return true;
}

void Motion::tick() {
  ticks_.store(ticks_.load() + 1U);
  if (!enabled_.load()) return;
  path(path_ticks_, report_.path_q);
  if (path_ticks_ == 0) copy(report_.path_q, report_.command_q);
  ++path_ticks_;
  if (const Correction* requested = requested_.exchange(nullptr); requested != nullptr && !begin_swap(*requested)) {
    swap_.store(Swap::refused);
  }
  const Correction* active = active_.load();
  if (active == nullptr && next_ == nullptr && !nominal_allowed_.load()) {
    report_ = {};
    path_ticks_ = 0;
    enabled_.store(false);
    return;
  }

  bool met = true;
  if (active == nullptr) {
    copy(report_.path_q, active_q_);
  } else {
    met = correct(*active, report_.path_q, active_q_) == Status::ok;
  }
  double wanted[joint_count];
  copy(active_q_, wanted);
  if (next_ != nullptr) {
    met = correct(*next_, report_.path_q, next_q_) == Status::ok && met;
    const double part = smooth(static_cast<double>(++ramp_) / static_cast<double>(ramp_ticks));
    for (std::int32_t i = 0; i < joint_count; ++i) wanted[i] += part * (next_q_[i] - active_q_[i]);
    if (ramp_ == ramp_ticks) {
      copy(next_q_, active_q_);
      active_.store(next_);
      next_ = nullptr;
      swap_.store(Swap::done);
    }
  }
  if (!met) ++report_.not_met;

  bool limited = false;
  for (std::int32_t i = 0; i < joint_count; ++i) {
    double step = wanted[i] - report_.command_q[i];
    if (!(std::fabs(step) <= max_step)) {
      limited = true;
      step = step > 0.0 ? max_step : step < 0.0 ? -max_step : 0.0;
    }
    report_.command_q[i] += step;
    if (std::fabs(step) > report_.largest_step) report_.largest_step = std::fabs(step);
  }
  if (limited) ++report_.limited;
}

}  // namespace firmware
