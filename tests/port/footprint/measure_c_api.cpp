// SPDX-License-Identifier: MIT
#include "mdhcal.h"
#include "meter.hpp"
#include "some_blob.hpp"

namespace footprint {

namespace {

// The C names of one precision.
template <class Real>
struct C;
#define MDHCAL_NAMES(REAL, PREFIX)                                                                                      \
  template <>                                                                                                           \
  struct C<REAL> {                                                                                                      \
    using Model = PREFIX##_calibrated_arm;                                                                              \
    using LoopState = PREFIX##_compensator;                                                                             \
    using Pose = PREFIX##_pose;                                                                                         \
    using Options = PREFIX##_tick_options;                                                                                   \
    using Report = PREFIX##_tick_report;                                                                                     \
    using RateLimits = PREFIX##_rate_limits;                                                                            \
    using Solutions = PREFIX##_solutions;                                                                               \
    static constexpr const char* prefix = #PREFIX;                                                                      \
    static constexpr auto load = PREFIX##_load;                                                                         \
    static constexpr auto joint_count = PREFIX##_joint_count;                                                           \
    static constexpr auto forward = PREFIX##_forward;                                                                   \
    static constexpr auto start_at_rest = PREFIX##_start_at_rest;                                                                       \
    static constexpr auto start_ramp = PREFIX##_start_ramp;                                                             \
    static constexpr auto advance_ramp = PREFIX##_advance_ramp;                                                                   \
    static constexpr auto default_tick_options = PREFIX##_default_tick_options;                                                   \
    static constexpr auto pose_to_joints = PREFIX##_pose_to_joints;                                                     \
    static constexpr auto joints_to_joints = PREFIX##_joints_to_joints;                                                 \
    static constexpr auto pose_to_pose = PREFIX##_pose_to_pose;                                                         \
    static constexpr auto joint_velocities = PREFIX##_joint_velocities;                                                 \
    static constexpr auto find_solutions = PREFIX##_find_solutions;                                                     \
    static constexpr auto cold_start = PREFIX##_cold_start;                                                             \
  }
MDHCAL_NAMES(double, mdhcal);
MDHCAL_NAMES(float, mdhcalf);
#undef MDHCAL_NAMES

std::uint8_t blob[mdhcal::blob_layout::size];
std::int32_t status;

template <class Real>
void measure_precision() {
  using N = C<Real>;
  using S = State<Real>;
  static typename N::Model model;
  static typename N::LoopState loop;
  static typename N::Options options;
  static typename N::Report report;
  static typename N::Pose pose, command;
  static typename N::RateLimits limits;
  for (Real& limit : limits.max_velocity) limit = 3;
  for (Real& limit : limits.max_acceleration) limit = 10;
  [[maybe_unused]] static typename N::Solutions solutions;
  static Real jacobian[MDHCAL_MAX_JOINTS][6];
  const auto row = [](const char* name, const char* set, int count, auto prepare, Call call) {
    char whole[64];
    std::snprintf(whole, sizeof whole, "%s_%s", N::prefix, name);
    measure(whole, precision_name<Real>, set, count, prepare, call);
  };
  const auto as_it_is = [](int) {};

  row("load", "blobs", tick_count<double>, [](int i) { some_blob(static_cast<std::uint64_t>(i) + 1, true, blob); },
      [] { status = N::load(&model, sizeof model, MDHCAL_ABI_VERSION, blob, sizeof blob, nullptr); });
  if (status != MDHCAL_OK && status != MDHCAL_SELF_TEST_TOLERANCE) std::printf("load: %s\n", mdhcal_status_text(status));
  some_blob(20220822, true, blob);  // the arm of the other rows
  status = N::load(&model, sizeof model, MDHCAL_ABI_VERSION, blob, sizeof blob, nullptr);
  row("joint_count", "any", 1, as_it_is, [] { status = N::joint_count(&model); });
  row("default_tick_options", "any", 1, as_it_is,
      [] { status = N::default_tick_options(&model, static_cast<Real>(0.001), &options); });
  row("start_at_rest", "any", 1, as_it_is, [] { status = N::start_at_rest(&loop, sizeof loop, &model, MDHCAL_CORRECTED); });
  row("start_ramp", "any", 1, as_it_is, [] { status = N::start_ramp(&loop, &model, MDHCAL_NOMINAL, 1000000); });
  row("advance_ramp", "any", input_count, as_it_is, [] { status = N::advance_ramp(&loop); });
  status = N::start_at_rest(&loop, sizeof loop, &model, MDHCAL_CORRECTED);

  Random random(6);
  for (const Set set : {Set::regular, Set::near_singular}) {
    // What these add to the C++ functions is the same near a singularity, where a call takes its time.
    const int count = set == Set::regular ? tick_count<Real> : input_count / 10;
    const auto anywhere = [&](int i) {
      double q_rad[6];
      joints(set, i, random, q_rad);
      S::set_joints(q_rad);
    };
    const auto on_path = [&](int i) {
      follow_path<Real>(set, i, random);
      std::copy_n(S::pose.quaternion, 4, pose.quaternion);
      std::copy_n(S::pose.position_m, 3, pose.position_m);
      std::copy_n(S::options.limits.max_step, mdhcal::max_joints, options.limits.max_step);
    };
    row("forward", name_of(set), input_count, anywhere,
        [] { status = N::forward(&model, MDHCAL_CORRECTED, S::q, &pose, jacobian); });
    row("pose_to_joints", name_of(set), count, on_path,
        [] { status = N::pose_to_joints(&loop, &options, &pose, S::q, &report); });
    row("joints_to_joints", name_of(set), count, on_path,
        [] { status = N::joints_to_joints(&loop, &options, S::meant_q, S::q, &report); });
    row("pose_to_pose", name_of(set), count, on_path,
        [] { status = N::pose_to_pose(&loop, &options, &pose, S::q, &command, &report); });
    row("joint_velocities", name_of(set), count, anywhere,
        [] { status = N::joint_velocities(&loop, S::q, S::velocity, static_cast<Real>(0.001), &limits, S::joint_velocity); });
  }
  if constexpr (!in_software<Real>) {
    status = N::default_tick_options(&model, static_cast<Real>(0.001), &options);
    const auto search = [&](int i) {
      double q_rad[6];
      joints(Set::mixed, i, random, q_rad);
      S::set_joints(q_rad);
      status = N::forward(&model, MDHCAL_CORRECTED, S::q, &pose, nullptr);
    };
    row("find_solutions", "mixed", input_count / 50, search,
        [] { status = N::find_solutions(&model, &options.goal, 0, &pose, S::q, &solutions); });
    row("cold_start", "mixed", input_count / 50, search,
        [] { status = N::cold_start(&model, &options.goal, 0, &pose, S::q); });
  }
}

}  // namespace

void measure_c_api() {
  [[maybe_unused]] static const char* words;
  measure("mdhcal_status_text", "-", "any", 30, [](int i) { status = i; }, [] { words = mdhcal_status_text(status); });
  measure_precision<double>();
  measure_precision<float>();
}

}  // namespace footprint
