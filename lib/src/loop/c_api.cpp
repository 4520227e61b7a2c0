// SPDX-License-Identifier: MIT
#include "mdhcal.h"

#include <string.h>

#include "mdhcal/mdhcal.hpp"
#include "number/convert.hpp"
#include "number/real.hpp"

#include "arm/rotation.hpp"
#include "loop/compensator_valid.hpp"

#define MDHCAL_JOIN_(a, b) a##b
#define MDHCAL_JOIN(a, b) MDHCAL_JOIN_(a, b)
#define MDHCAL_PREFIX_double mdhcal_
#define MDHCAL_PREFIX_float mdhcalf_
#define C(name) MDHCAL_JOIN(MDHCAL_JOIN(MDHCAL_PREFIX_, MDHCAL_REAL), name)

namespace mdhcal {

namespace {

static_assert(sizeof(CalibratedArm<Real>) <= sizeof(C(calibrated_arm)) && sizeof(Compensator<Real>) <= sizeof(C(compensator)));
static_assert(alignof(CalibratedArm<Real>) <= alignof(C(calibrated_arm)) &&
              alignof(Compensator<Real>) <= alignof(C(compensator)));
static_assert(MDHCAL_MAX_JOINTS == max_joints && MDHCAL_MAX_SOLUTIONS == max_solutions && MDHCAL_MAX_TARGETS == max_targets);
static_assert(sizeof(mdhcal_description) == sizeof(BlobDescription) && sizeof(mdhcal_provenance) == sizeof(BlobProvenance) &&
              sizeof(mdhcal_target) == sizeof(Target) && sizeof(mdhcal_tolerances) == sizeof(Tolerances));
static_assert(offsetof(mdhcal_description, target) == offsetof(BlobDescription, target) &&
              offsetof(mdhcal_description, family) == offsetof(BlobDescription, family) &&
              offsetof(mdhcal_description, provenance) == offsetof(BlobDescription, provenance) &&
              offsetof(mdhcal_provenance, lambda) == offsetof(BlobProvenance, lambda) &&
              offsetof(mdhcal_provenance, lean_max_m) == offsetof(BlobProvenance, lean_max_m));

// Whether storage may hold what a C program says: it can make a pointer of any address.
bool aligned(const void* storage) {
  return storage != nullptr && reinterpret_cast<std::uintptr_t>(storage) % alignof(double) == 0;
}

// Storage that memcpy made an object of; void on the way, since nothing else is known of it.
const CalibratedArm<Real>* arm_in(const C(calibrated_arm)* storage) {
  if (!aligned(storage)) return nullptr;
  const CalibratedArm<Real>* arm = static_cast<const CalibratedArm<Real>*>(static_cast<const void*>(storage));
  if (arm->nominal.mark != arm_mark<Real> || arm->corrected.mark != arm_mark<Real>) return nullptr;
  // A copy of the bytes refers to the joint functions of what it was copied from.
  const JointFunctionTable* functions = arm->corrected.terms.functions;
  return functions == nullptr || functions == &arm->functions ? arm : nullptr;
}

const Compensator<Real>* compensator_in(const C(compensator)* storage) {
  if (!aligned(storage)) return nullptr;
  const Compensator<Real>* compensator = static_cast<const Compensator<Real>*>(static_cast<const void*>(storage));
  return valid(*compensator) ? compensator : nullptr;
}

Compensator<Real>* compensator_in(C(compensator)* storage) {
  return const_cast<Compensator<Real>*>(compensator_in(static_cast<const C(compensator)*>(storage)));
}

const Arm<Real>* model_in(const C(calibrated_arm)* storage, std::int32_t model) {
  const CalibratedArm<Real>* arm = arm_in(storage);
  if (arm == nullptr || (model != MDHCAL_NOMINAL && model != MDHCAL_CORRECTED)) return nullptr;
  return model == MDHCAL_CORRECTED ? &arm->corrected : &arm->nominal;
}

std::int32_t number(Status status) { return static_cast<std::int32_t>(status); }
constexpr std::int32_t refused = static_cast<std::int32_t>(Status::bad_input);

Pose<Real> from_c(const C(pose)& pose) {
  Pose<Real> out;
  for (int k = 0; k < 4; ++k) out.quaternion[k] = pose.quaternion[k];
  for (int k = 0; k < 3; ++k) out.position_m[k] = pose.position_m[k];
  return out;
}

void to_c(const Pose<Real>& pose, C(pose)& out) {
  for (int k = 0; k < 4; ++k) out.quaternion[k] = pose.quaternion[k];
  for (int k = 0; k < 3; ++k) out.position_m[k] = pose.position_m[k];
}

GoalOptions<Real> from_c(const C(goal_options)& goal) {
  return {goal.position_tolerance_m, goal.rotation_tolerance_rad, goal.position_weight, goal.rotation_weight,
          static_cast<Task>(goal.task)};
}

TickOptions<Real> from_c(const C(tick_options)& options) {
  TickOptions<Real> out;
  out.goal = from_c(options.goal);
  for (std::size_t j = 0; j < max_joints; ++j) {
    out.limits.max_step[j] = options.limits.max_step[j];
    out.posture.q[j] = options.posture.q[j];
  }
  out.posture.gain = options.posture.gain;
  out.max_iterations = options.max_iterations;
  return out;
}

void to_c(const TickOptions<Real>& options, C(tick_options)& out) {
  out.goal = {options.goal.position_tolerance_m, options.goal.rotation_tolerance_rad, options.goal.position_weight,
              options.goal.rotation_weight, static_cast<std::int32_t>(options.goal.task)};
  for (std::size_t j = 0; j < max_joints; ++j) {
    out.limits.max_step[j] = options.limits.max_step[j];
    out.posture.q[j] = options.posture.q[j];
  }
  out.posture.gain = options.posture.gain;
  out.max_iterations = options.max_iterations;
}

std::int32_t finish(Status status, const TickReport<Real>& report, C(tick_report)* out) {
  if (out != nullptr && status != Status::bad_input) {
    out->position_error_m = report.position_error_m;
    out->rotation_error_rad = report.rotation_error_rad;
    out->smallest_singular_value = report.smallest_singular_value;
    out->iterations = report.iterations;
    out->step_mask = report.step_mask;
    out->limit_mask = report.limit_mask;
    out->unseen_mask = report.unseen_mask;
  }
  return number(status);
}

JointRateLimits<Real> from_c(const C(rate_limits)& limits) {
  JointRateLimits<Real> out;
  for (std::size_t j = 0; j < max_joints; ++j) {
    out.max_velocity[j] = limits.max_velocity[j];
    out.max_acceleration[j] = limits.max_acceleration[j];
  }
  return out;
}

// The C verifier behind the C++ one.
bool verify_for_c(const std::uint8_t* message, std::size_t size, const std::uint8_t* signature, void* context) {
  const mdhcal_demands* demands = static_cast<const mdhcal_demands*>(context);
  return demands->verify(message, size, signature, demands->verify_context) == 1;
}

}  // namespace

}  // namespace mdhcal

extern "C" {

using namespace mdhcal;

std::int32_t C(load)(C(calibrated_arm)* arm, std::size_t arm_size, std::uint32_t abi_version, const std::uint8_t* blob,
                     std::size_t blob_bytes, const mdhcal_demands* demands) {
  if (!aligned(arm) || arm_size != sizeof *arm || abi_version != MDHCAL_ABI_VERSION) return refused;
  DecodeOptions options;
  mdhcal_demands copy{};
  if (demands != nullptr) {
    copy = *demands;
    options.serial = copy.serial;
    options.minimum_counter = copy.minimum_counter;
    if (copy.verify != nullptr) options.verifier = {verify_for_c, &copy};
  }
  return number(load(blob, blob_bytes, options, *static_cast<CalibratedArm<Real>*>(static_cast<void*>(arm))));
}

std::int32_t C(joint_count)(const C(calibrated_arm)* arm) {
  const CalibratedArm<Real>* a = arm_in(arm);
  return a == nullptr ? 0 : a->corrected.joint_count;
}

std::int32_t C(describe_joint)(const C(calibrated_arm)* arm, std::int32_t index, mdhcal_joint* joint) {
  const CalibratedArm<Real>* a = arm_in(arm);
  if (a == nullptr || joint == nullptr || index < 0 || index >= a->corrected.joint_count) return refused;
  const std::uint32_t shift = static_cast<std::uint32_t>(index);
  joint->slides = static_cast<std::int32_t>((a->corrected.prismatic_mask >> shift) & 1U);
  joint->has_min = static_cast<std::int32_t>((a->corrected.min_mask >> shift) & 1U);
  joint->has_max = static_cast<std::int32_t>((a->corrected.max_mask >> shift) & 1U);
  joint->min = 0;
  joint->max = 0;
  if (joint->has_min != 0) convert(a->corrected.min[index], joint->min);
  if (joint->has_max != 0) convert(a->corrected.max[index], joint->max);
  return number(Status::ok);
}

std::int32_t C(describe)(const C(calibrated_arm)* arm, mdhcal_description* description) {
  const CalibratedArm<Real>* a = arm_in(arm);
  if (a == nullptr || description == nullptr) return refused;
  memcpy(description, &a->description, sizeof *description);
  return number(Status::ok);
}

std::int32_t C(find_target)(const C(calibrated_arm)* arm, const char* name, C(pose)* flange_T_target) {
  const CalibratedArm<Real>* a = arm_in(arm);
  const Target* target = a == nullptr ? nullptr : find_target(a->description, name);
  if (target == nullptr || flange_T_target == nullptr) return refused;
  to_c(identity_pose<Real>(), *flange_T_target);
  for (int k = 0; k < 3; ++k) convert(target->flange_p_m[k], flange_T_target->position_m[k]);
  return number(Status::ok);
}

std::int32_t C(forward)(const C(calibrated_arm)* arm, std::int32_t model, const Real* q, C(pose)* base_T_flange,
                        Real (*jacobian)[6]) {
  const Arm<Real>* a = model_in(arm, model);
  if (a == nullptr || q == nullptr || base_T_flange == nullptr) return refused;
  Pose<Real> pose;
  Jacobian<Real> columns;
  const Status status = jacobian == nullptr ? forward(*a, q, pose) : forward(*a, q, pose, columns);
  if (status != Status::ok) return number(status);
  to_c(pose, *base_T_flange);
  for (std::int32_t j = 0; jacobian != nullptr && j < a->joint_count; ++j) {
    for (int k = 0; k < 6; ++k) jacobian[j][k] = columns.column[j][k];
  }
  return number(status);
}

std::int32_t C(link_frames)(const C(calibrated_arm)* arm, std::int32_t model, const Real* q, C(pose)* frames) {
  const Arm<Real>* a = model_in(arm, model);
  if (a == nullptr || q == nullptr || frames == nullptr) return refused;
  Frame<Real> along[max_joints + 2];
  const Status status = link_frames(*a, q, along);
  for (std::int32_t i = 0; status == Status::ok && i < a->joint_count + 2; ++i) {
    Pose<Real> pose;
    to_pose(along[i], pose);
    to_c(pose, frames[i]);
  }
  return number(status);
}

std::int32_t C(multiply)(const C(pose)* a_T_b, const C(pose)* b_T_c, C(pose)* a_T_c) {
  if (a_T_b == nullptr || b_T_c == nullptr || a_T_c == nullptr) return refused;
  Pose<Real> product;
  const Status status = multiply(from_c(*a_T_b), from_c(*b_T_c), product);
  if (status == Status::ok) to_c(product, *a_T_c);
  return number(status);
}

std::int32_t C(invert)(const C(pose)* a_T_b, C(pose)* b_T_a) {
  if (a_T_b == nullptr || b_T_a == nullptr) return refused;
  Pose<Real> inverse;
  const Status status = invert(from_c(*a_T_b), inverse);
  if (status == Status::ok) to_c(inverse, *b_T_a);
  return number(status);
}

std::int32_t C(start_at_rest)(C(compensator)* compensator, std::size_t size, const C(calibrated_arm)* arm,
                              std::int32_t model) {
  const CalibratedArm<Real>* a = arm_in(arm);
  if (a == nullptr || !aligned(compensator) || size != sizeof *compensator) return refused;
  return number(start_at_rest(*a, static_cast<Model>(model),
                              *static_cast<Compensator<Real>*>(static_cast<void*>(compensator))));
}

std::int32_t C(start_ramp)(C(compensator)* compensator, const C(calibrated_arm)* arm, std::int32_t model,
                           std::uint32_t ticks) {
  Compensator<Real>* c = compensator_in(compensator);
  const CalibratedArm<Real>* a = arm_in(arm);
  return c == nullptr || a == nullptr ? refused : number(start_ramp(*c, *a, static_cast<Model>(model), ticks));
}

std::int32_t C(start_frame_ramp)(C(compensator)* compensator, const C(pose)* base_T_user, const C(pose)* flange_T_tool,
                                 std::uint32_t ticks) {
  Compensator<Real>* c = compensator_in(compensator);
  if (c == nullptr || base_T_user == nullptr || flange_T_tool == nullptr) return refused;
  return number(start_frame_ramp(*c, {from_c(*base_T_user), from_c(*flange_T_tool)}, ticks));
}

std::int32_t C(start_payload_ramp)(C(compensator)* compensator, Real payload_kg, std::uint32_t ticks) {
  Compensator<Real>* c = compensator_in(compensator);
  return c == nullptr ? refused : number(start_payload_ramp(*c, payload_kg, ticks));
}

std::int32_t C(refers_to)(const C(compensator)* compensator, const C(calibrated_arm)* arm) {
  const Compensator<Real>* c = compensator_in(compensator);
  const CalibratedArm<Real>* a = arm_in(arm);
  return c != nullptr && a != nullptr && refers_to(*c, *a) ? 1 : 0;
}

std::int32_t C(advance_ramp)(C(compensator)* compensator) {
  Compensator<Real>* c = compensator_in(compensator);
  return c == nullptr ? refused : number(advance_ramp(*c));
}

std::uint32_t C(ramp_ticks_left)(const C(compensator)* compensator) {
  const Compensator<Real>* c = compensator_in(compensator);
  return c == nullptr ? 0U : ramp_ticks_left(*c);
}

std::int32_t C(default_tick_options)(const C(calibrated_arm)* arm, Real period_s, C(tick_options)* options) {
  const CalibratedArm<Real>* a = arm_in(arm);
  if (a == nullptr || options == nullptr || !(period_s > Real{0} && period_s <= Real(1e3))) return refused;
  to_c(default_tick_options(*a, period_s), *options);
  return number(Status::ok);
}

std::int32_t C(pose_to_joints)(const C(compensator)* compensator, const C(tick_options)* options,
                               const C(pose)* user_T_tool, Real* q, C(tick_report)* report) {
  const Compensator<Real>* c = compensator_in(compensator);
  if (c == nullptr || options == nullptr || user_T_tool == nullptr || q == nullptr) return refused;
  TickReport<Real> done{};
  return finish(pose_to_joints(*c, from_c(*options), from_c(*user_T_tool), q, &done), done, report);
}

std::int32_t C(joints_to_joints)(const C(compensator)* compensator, const C(tick_options)* options,
                                 const Real* nominal_q, Real* q, C(tick_report)* report) {
  const Compensator<Real>* c = compensator_in(compensator);
  if (c == nullptr || options == nullptr || nominal_q == nullptr || q == nullptr) return refused;
  TickReport<Real> done{};
  return finish(joints_to_joints(*c, from_c(*options), nominal_q, q, &done), done, report);
}

std::int32_t C(pose_to_pose)(const C(compensator)* compensator, const C(tick_options)* options, const C(pose)* user_T_tool,
                             Real* q, C(pose)* command, C(tick_report)* report) {
  const Compensator<Real>* c = compensator_in(compensator);
  if (c == nullptr || options == nullptr || user_T_tool == nullptr || q == nullptr || command == nullptr) return refused;
  TickReport<Real> done{};
  Pose<Real> pose;
  const Status status = pose_to_pose(*c, from_c(*options), from_c(*user_T_tool), q, pose, &done);
  if (status != Status::bad_input) to_c(pose, *command);
  return finish(status, done, report);
}

std::int32_t C(joint_velocities)(const C(compensator)* compensator, const Real* q, const Real* tool_velocity,
                                 Real period_s, const C(rate_limits)* limits, Real* velocity) {
  const Compensator<Real>* c = compensator_in(compensator);
  if (c == nullptr || q == nullptr || tool_velocity == nullptr || limits == nullptr || velocity == nullptr) return refused;
  return number(joint_velocities(*c, q, tool_velocity, period_s, from_c(*limits), velocity));
}

std::int32_t C(joint_accelerations)(const C(calibrated_arm)* arm, const Real* q, const Real* velocity,
                                    const Real* flange_acceleration, const C(rate_limits)* limits, Real* acceleration) {
  const CalibratedArm<Real>* a = arm_in(arm);
  if (a == nullptr || q == nullptr || velocity == nullptr || flange_acceleration == nullptr || limits == nullptr ||
      acceleration == nullptr) {
    return refused;
  }
  return number(joint_accelerations(a->corrected, q, velocity, flange_acceleration, from_c(*limits), acceleration));
}

std::int32_t C(find_solutions)(const C(calibrated_arm)* arm, const C(goal_options)* goal, std::int32_t restarts,
                               const C(pose)* base_T_flange, const Real* posture, C(solutions)* solutions) {
  const CalibratedArm<Real>* a = arm_in(arm);
  if (a == nullptr || goal == nullptr || base_T_flange == nullptr || posture == nullptr || solutions == nullptr) {
    return refused;
  }
  const SolutionOptions<Real> how{from_c(*goal), restarts};
  Solutions<Real> found;
  const Status status = find_solutions(a->corrected, how, from_c(*base_T_flange), posture, found);
  if (status == Status::bad_input) return refused;
  solutions->count = found.count;
  for (std::int32_t k = 0; k < found.count; ++k) {
    for (std::int32_t j = 0; j < a->corrected.joint_count; ++j) solutions->q[k][j] = found.q[k][j];
    solutions->distance[k] = found.distance[k];
  }
  return number(status);
}

std::int32_t C(cold_start)(const C(calibrated_arm)* arm, const C(goal_options)* goal, std::int32_t restarts,
                           const C(pose)* base_T_flange, Real* q) {
  const CalibratedArm<Real>* a = arm_in(arm);
  if (a == nullptr || goal == nullptr || base_T_flange == nullptr || q == nullptr) return refused;
  const SolutionOptions<Real> how{from_c(*goal), restarts};
  return number(cold_start(a->corrected, how, from_c(*base_T_flange), q));
}

}  // extern "C"
