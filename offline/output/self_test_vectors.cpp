// SPDX-License-Identifier: MIT
#include "offline/output/self_test_vectors.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "mdhcal/arm.hpp"
#include "mdhcal/inverse.hpp"
#include "mdhcal/kinematics.hpp"
#include "mdhcal/self_test.hpp"
#include "offline/base/error.hpp"
#include "offline/robot/robot.hpp"

namespace mdhcal::offline {

namespace {

constexpr int candidate_count = 64;
constexpr double revolute_range_rad = 2.0;   // where a joint states no limit
constexpr double prismatic_range_m = 0.25;
constexpr double step = 0x1p-10;  // binary32 holds every multiple in range, so both precisions start from the same q
constexpr double agreement = 1e-12;  // the inverse is done well below its tolerance: its last step was not a close call
constexpr double agreement_float = 2e-6;

struct Candidate {
  SelfTestVector<double> in_double{};
  SelfTestVector<float> in_float{};
  double score = 0;  // smallest singular value if all is well, else below zero
};

// Inside the limits, with room for the seed's offset where the range leaves it.
Joints draw(const Geometry& geometry, std::mt19937_64& random) {
  Joints q{};
  for (std::size_t i = 0; i < static_cast<std::size_t>(geometry.joint_count); ++i) {
    const Joint& joint = geometry.joint[i];
    const double range = joint.kind == JointKind::revolute ? revolute_range_rad : prismatic_range_m;
    double low = joint.has_min != 0 ? joint.min : (joint.has_max != 0 ? std::min(-range, joint.max - 2 * range) : -range);
    double high = joint.has_max != 0 ? joint.max : std::max(range, low + 2 * range);
    const double margin = std::min(2 * self_test_offset, (high - low) / 2);
    low += margin;
    high -= margin;
    const double unit = static_cast<double>(random() >> 11U) * 0x1p-53;
    q[i] = std::clamp(std::round((low + unit * (high - low)) / step) * step, -max_reading, max_reading);
  }
  return q;
}

template <class Real>
double run(const Arm<Real>& arm, const Joints& readings, Real position_tolerance_m, Real rotation_tolerance_rad,
           double accepted, SelfTestVector<Real>& vector) {
  std::array<Real, max_joints> q{};
  for (std::size_t i = 0; i < static_cast<std::size_t>(arm.joint_count); ++i) {
    vector.q[i] = static_cast<Real>(readings[i]);
    const Real offset = static_cast<Real>(self_test_offset);
    q[i] = vector.q[i] + (i % 2 == 0 ? offset : -offset);
  }
  TickOptions<Real> options = default_tick_options(arm);
  options.goal.position_tolerance_m = position_tolerance_m;
  options.goal.rotation_tolerance_rad = rotation_tolerance_rad;
  TickReport<Real> report{};
  if (forward(arm, vector.q, vector.base_T_flange) != Status::ok) return -1;
  const Status status = tick(arm, options, vector.base_T_flange, q.data(), &report);
  vector.inverse_status = static_cast<std::int32_t>(status);
  std::copy(q.begin(), q.end(), vector.inverse_q);
  const bool done = status == Status::ok && report.position_error_m <= static_cast<Real>(accepted) &&
                    report.rotation_error_rad <= static_cast<Real>(accepted);
  return done ? static_cast<double>(report.smallest_singular_value) : -1;
}

}  // namespace

void fill_self_test_vectors(BlobContent& model) {
  Arm<double> arm{};
  Arm<float> arm_float{};
  const auto table = std::make_unique<JointFunctionTable>();
  const Status status = make_arm(model.geometry, model.transmission, *table, arm);
  if (status == Status::blob_deviation) {
    throw Refusal("A joint function or the sag is over what a controller accepts: the amplitudes of a joint's orders sum up to more than " +
                  std::to_string(default_max_joint_function_rad * 1e3) + " mrad or their slopes to more than " +
                  std::to_string(default_max_joint_function_slope) + ", or a joint may sag by more than " +
                  std::to_string(max_sag_rad() * 1e3) + " mrad.");
  }
  if (status != Status::ok || make_arm(model.geometry, model.transmission, *table, arm_float) != Status::ok) {
    throw Refusal("The corrected geometry or its transmission is not valid: a value is out of range.");
  }
  make_table(model.transmission, *table);
  std::mt19937_64 random(20261121);
  std::vector<Candidate> candidates(candidate_count);
  for (Candidate& candidate : candidates) {
    const Joints q = draw(model.geometry, random);
    const double score = run(arm, q, model.tolerances.position_m, model.tolerances.rotation_rad, agreement, candidate.in_double);
    const double score_float = run(arm_float, q, model.tolerances.float_position_m, model.tolerances.float_rotation_rad,
                                   agreement_float, candidate.in_float);
    candidate.score = std::min(score, score_float);
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.score > b.score; });
  model.arithmetic_id = arithmetic_id;
  model.double_vector_count = model.float_vector_count = static_cast<std::int32_t>(max_vectors);
  for (std::size_t i = 0; i < max_vectors; ++i) {
    model.double_vector[i] = candidates[i].in_double;
    model.float_vector[i] = candidates[i].in_float;
  }
}

}  // namespace mdhcal::offline
