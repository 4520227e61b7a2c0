// SPDX-License-Identifier: MIT
#include "meter.hpp"

namespace footprint {

namespace {

using namespace mdhcal;

template <class Real>
void measure_ramp() {
  using S = State<Real>;
  const char* precision = precision_name<Real>;
  const auto half_way = [](int i) {
    S::status = start_at_rest(S::calibrated, i % 2 == 0 ? Model::corrected : Model::nominal, S::ramp);
    S::status = start_ramp(S::ramp, S::calibrated, i % 2 != 0 ? Model::corrected : Model::nominal,
                           static_cast<std::uint32_t>(i) + 2U);
    S::status = advance_ramp(S::ramp);
  };
  measure("start_at_rest", precision, "any", input_count, half_way,
          [] { S::status = start_at_rest(S::calibrated, Model::corrected, S::ramp); });
  measure("start_ramp", precision, "any", input_count, half_way,
          [] { S::status = start_ramp(S::ramp, S::calibrated, Model::corrected, 1000); });
  measure("advance_ramp", precision, "any", input_count, half_way, [] { S::status = advance_ramp(S::ramp); });
}

// The three forms on a path, at rest and in the middle of a ramp; and the first tick after a swap without a ramp, which ends at the step limit.
template <class Real>
void measure_forms() {
  using S = State<Real>;
  static TickReport<Real> report;
  const auto three = [](const char* set, int count, auto prepare) {
    const char* precision = precision_name<Real>;
    measure("pose_to_joints", precision, set, count, prepare,
            [] { S::status = pose_to_joints(S::ramp, S::options, S::pose, S::q, &report); });
    measure("joints_to_joints", precision, set, count, prepare,
            [] { S::status = joints_to_joints(S::ramp, S::options, S::meant_q, S::q, &report); });
    measure("pose_to_pose", precision, set, count, prepare,
            [] { S::status = pose_to_pose(S::ramp, S::options, S::pose, S::q, S::command, &report); });
  };
  Random random(4);
  for (const bool ramping : {false, true}) {
    S::status = start_at_rest(S::calibrated, ramping ? Model::nominal : Model::corrected, S::ramp);
    if (ramping) {
      S::status = start_ramp(S::ramp, S::calibrated, Model::corrected, 2);
      S::status = advance_ramp(S::ramp);
    }
    for (Set set : {Set::regular, Set::near_singular}) {
      char name[32];
      std::snprintf(name, sizeof name, "%s,%s", name_of(set), ramping ? "ramp" : "rest");
      three(name, tick_count<Real>, [&](int i) { follow_path<Real>(set, i, random); });
    }
  }
  S::status = start_at_rest(S::calibrated, Model::corrected, S::ramp);
  three("swap", input_count / 10, [&](int i) {
    follow_path<Real>(Set::mixed, i, random);
    for (int k = 0; k < 6; ++k) S::q[k] = S::meant_q[k];
  });
}

template <class Real>
void measure_velocities() {
  using S = State<Real>;
  for (int i = 0; i < 6; ++i) {
    S::velocity[i] = static_cast<Real>(i % 2 == 0 ? 0.1 : -0.2);
    S::rate_limits.max_velocity[i] = 3;
    S::rate_limits.max_acceleration[i] = 10;
  }
  Random random(5);
  for (Set set : {Set::regular, Set::near_singular}) {
    measure("joint_velocities", precision_name<Real>, name_of(set), tick_count<Real>,
            [&](int i) {
              double q_rad[6];
              joints(set, i, random, q_rad);
              S::set_joints(q_rad);
            },
            [] { S::status = joint_velocities(S::arm, S::q, S::velocity, S::rate_limits, S::joint_velocity); });
  }
}

// From nowhere, the posture anywhere. In software it is a thousand million instructions a call.
template <class Real>
void measure_solutions() {
  using S = State<Real>;
  static SolutionOptions<Real> options;
  static Solutions<Real> solutions;
  constexpr int count = input_count / 10;
  options = default_solution_options(S::arm);
  Random random(3);
  const auto prepare = [&](int i) {
    double q_rad[6];
    joints(Set::mixed, i, random, q_rad);
    S::set_joints(q_rad);
    S::status = forward(S::arm, S::q, S::pose);
    joints(Set::regular, i, random, q_rad);
    S::set_joints(q_rad);
  };
  measure("find_solutions", precision_name<Real>, "mixed", count, prepare,
          [] { S::status = find_solutions(S::arm, options, S::pose, S::q, solutions); });
  measure("cold_start", precision_name<Real>, "mixed", count, prepare,
          [] { S::status = cold_start(S::arm, options, S::pose, S::q); });
}

template <class Real>
void measure_precision() {
  using S = State<Real>;
  S::status = make_calibrated_arm(nominal_arm(), calibrated_arm(), S::calibrated);
  S::arm = S::calibrated.corrected;
  measure_ramp<Real>();
  measure_forms<Real>();
  measure_velocities<Real>();
  if constexpr (!in_software<Real>) measure_solutions<Real>();
}

}  // namespace

void measure_compensator() {
  measure_precision<double>();
  measure_precision<float>();
}

}  // namespace footprint
