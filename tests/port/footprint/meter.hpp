// SPDX-License-Identifier: MIT
// One line of output for one function, precision and input set; and what the measured calls work on.
#pragma once

#include <algorithm>
#include <array>
#include <cstdio>
#include <type_traits>

#include "counter.hpp"
#include "inputs.hpp"
#include "mdhcal/compensator.hpp"
#include "mdhcal/solutions.hpp"

namespace footprint {

/// `prepare(i)` sets the input of call number i; the call itself takes no argument.
template <class Prepare>
void measure(const char* name, const char* precision, const char* set, int count, Prepare prepare, Call call) {
  static std::array<std::uint32_t, input_count> spent;
  const std::uint32_t overhead = cost_of([] {}).instructions;
  std::uint32_t stack_bytes = 0;
  for (int i = 0; i < count; ++i) {
    prepare(i);
    const Cost cost = cost_of(call);
    spent[static_cast<std::size_t>(i)] = cost.instructions - overhead;
    stack_bytes = std::max(stack_bytes, cost.stack_bytes);
  }
  std::sort(spent.begin(), spent.begin() + count);
  const auto at = [](int i) { return static_cast<unsigned long>(spent[static_cast<std::size_t>(i)]); };
  std::printf("cost %s %s %s %d %lu %lu %lu %lu\n", name, precision, set, count, at(0), at(count / 2), at(count - 1),
              static_cast<unsigned long>(stack_bytes));
  std::fflush(stdout);
}

template <class Real>
inline constexpr const char* precision_name = std::is_same_v<Real, double> ? "double" : "float";

/// Double without an FPU for it is software, and no one's servo loop.
#if defined(__ARM_FP) && (__ARM_FP & 8) == 0
template <class Real>
inline constexpr bool in_software = sizeof(Real) == 8;
#else
template <class Real>
inline constexpr bool in_software = false;
#endif

/// How many inputs a function of some ten thousand instructions gets.
template <class Real>
inline constexpr int tick_count = in_software<Real> ? input_count / 10 : input_count;

template <class Real>
struct State {
  static inline mdhcal::Arm<Real> arm;
  static inline Real q[mdhcal::max_joints], meant_q[mdhcal::max_joints];
  static inline mdhcal::Pose<Real> pose, command;
  static inline mdhcal::TickOptions<Real> options;
  static inline mdhcal::CalibratedArm<Real> calibrated;
  static inline mdhcal::Compensator<Real> ramp;
  static inline Real velocity[6], joint_velocity[mdhcal::max_joints];
  static inline mdhcal::JointRateLimits<Real> rate_limits;
  static inline mdhcal::Status status;

  static void set_joints(const double (&q_rad)[6]) {
    for (int k = 0; k < 6; ++k) q[k] = static_cast<Real>(q_rad[k]);
  }
  /// One tick at 1 kHz moves no joint further [rad].
  static void limit_steps() {
    for (Real& step : options.limits.max_step) step = static_cast<Real>(0.00314);
  }
};

/// An input of a compensator that follows a path: `pose` and `meant_q` are up to 3 mrad a joint from where `q` is.
template <class Real>
void follow_path(Set set, int i, Random& random) {
  using S = State<Real>;
  double q_rad[6];
  joints(set, i, random, q_rad);
  S::set_joints(q_rad);
  for (int k = 0; k < 6; ++k) S::meant_q[k] = S::q[k];
  S::status = forward(S::calibrated.nominal, S::meant_q, S::pose);
  S::options = default_tick_options(S::arm);
  S::status = joints_to_joints(S::ramp, S::options, S::meant_q, S::q);
  for (int k = 0; k < 6; ++k) S::q[k] += static_cast<Real>(random.uniform(-0.003, 0.003));
  S::limit_steps();
}

void measure_arm();          ///< preparing, kinematics, tick
void measure_compensator();  ///< and the searches for solutions
void measure_blob();         ///< and the store
void measure_c_api();

}  // namespace footprint
