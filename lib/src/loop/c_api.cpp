// SPDX-License-Identifier: MIT
#include "mdhcal.h"

#include <cstring>

#include "mdhcal/blob.hpp"
#include "mdhcal/compensator.hpp"
#include "mdhcal/environment.hpp"
#include "mdhcal/self_test.hpp"
#include "mdhcal/solutions.hpp"
#include "number/real.hpp"

#define MDHCAL_JOIN_(a, b) a##b
#define MDHCAL_JOIN(a, b) MDHCAL_JOIN_(a, b)
#define MDHCAL_PREFIX_double mdhcal_
#define MDHCAL_PREFIX_float mdhcalf_
#define C(name) MDHCAL_JOIN(MDHCAL_JOIN(MDHCAL_PREFIX_, MDHCAL_REAL), name)

namespace mdhcal {

namespace {

// Storage that was not initialised holds another number, save with a chance of 2^-32.
constexpr std::uint32_t model_mark = sizeof(Real) == sizeof(double) ? 0x6D1F83A5U : 0x2B9C40E7U;
constexpr std::uint32_t state_mark = sizeof(Real) == sizeof(double) ? 0xC45A7E19U : 0x91E3D60BU;

struct CModel {
  std::uint32_t mark;
  CompensatorModel<Real> models;
};

struct CState {
  std::uint32_t mark;
  CompensatorState<Real> ramp;
};

static_assert(sizeof(C(model)) == MDHCAL_MODEL_SIZE && sizeof(C(state)) == MDHCAL_STATE_SIZE);
static_assert(sizeof(CModel) <= MDHCAL_MODEL_SIZE && sizeof(CState) <= MDHCAL_STATE_SIZE);
static_assert(alignof(CModel) <= alignof(C(model)) && alignof(CState) <= alignof(C(state)));
static_assert(MDHCAL_MAX_JOINTS == max_joints && MDHCAL_MAX_SOLUTIONS == max_solutions);

// Whether storage may hold a CModel or a CState: a C program can make a pointer of any address.
bool aligned(const void* storage) {
  return storage != nullptr && reinterpret_cast<std::uintptr_t>(storage) % alignof(double) == 0;
}

// Bytes that memcpy made a CModel of; void on the way, since nothing else is known of the storage.
const CModel* model_in(const C(model)* storage) {
  if (!aligned(storage)) return nullptr;
  const CModel* model = static_cast<const CModel*>(static_cast<const void*>(storage));
  return model->mark == model_mark ? model : nullptr;
}

bool read_state(const C(state)* storage, CState& state) {
  if (!aligned(storage)) return false;
  std::memcpy(&state, storage, sizeof state);
  return state.mark == state_mark;
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
  }
  return number(status);
}

// The C verifier behind the C++ one.
bool verify_for_c(const std::uint8_t* message, std::size_t size, const std::uint8_t* signature, void* context) {
  const mdhcal_demands* demands = static_cast<const mdhcal_demands*>(context);
  return demands->verify(message, size, signature, demands->verify_context) == 1;
}

Status load(const std::uint8_t* blob, std::size_t blob_size, const mdhcal_demands* demands, CModel& loaded) {
  DecodeOptions options;
  mdhcal_demands copy{};
  if (demands != nullptr) {
    copy = *demands;
    options.serial = copy.serial;
    options.minimum_counter = copy.minimum_counter;
    if (copy.verify != nullptr) options.verifier = {verify_for_c, &copy};
  }
  BlobContent model;
  const Status status = decode(blob, blob_size, options, model);
  if (status != Status::ok) return status;
  Geometry nominal = model.geometry;
  for (std::size_t i = 0; i < max_joints; ++i) nominal.link[i] = model.nominal[i];
  const Status made = make_compensator(nominal, model.geometry, loaded.models);
  return made == Status::ok ? self_test(model, loaded.models.corrected) : made;
}

}  // namespace

}  // namespace mdhcal

extern "C" {

using namespace mdhcal;

std::int32_t C(load)(C(model)* model, std::size_t model_size, std::uint32_t abi_version, const std::uint8_t* blob,
                     std::size_t blob_bytes, const mdhcal_demands* demands) {
  if (!aligned(model) || blob == nullptr || model_size != sizeof *model || abi_version != MDHCAL_ABI_VERSION) {
    return refused;
  }
  CModel loaded;
  loaded.mark = model_mark;
  const Status status = load(blob, blob_bytes, demands, loaded);
  if (status == Status::ok || status == Status::self_test_tolerance) std::memcpy(model, &loaded, sizeof loaded);
  return number(status);
}

std::int32_t C(joint_count)(const C(model)* model) {
  const CModel* m = model_in(model);
  return m == nullptr ? 0 : m->models.corrected.joint_count;
}

std::int32_t C(forward)(const C(model)* model, std::int32_t which, const Real* q, C(pose)* base_T_flange,
                        Real (*jacobian)[6]) {
  const CModel* m = model_in(model);
  if (m == nullptr || q == nullptr || base_T_flange == nullptr) return refused;
  if (which != MDHCAL_NOMINAL && which != MDHCAL_CORRECTED) return refused;
  const Arm<Real>& arm = which == MDHCAL_CORRECTED ? m->models.corrected : m->models.nominal;
  Pose<Real> pose;
  if (jacobian == nullptr) {
    const Status status = forward(arm, q, pose);
    if (status == Status::ok) to_c(pose, *base_T_flange);
    return number(status);
  }
  Jacobian<Real> columns;
  const Status status = forward(arm, q, pose, columns);
  if (status != Status::ok) return number(status);
  to_c(pose, *base_T_flange);
  for (std::int32_t j = 0; j < arm.joint_count; ++j) {
    for (int k = 0; k < 6; ++k) jacobian[j][k] = columns.column[j][k];
  }
  return number(status);
}

std::int32_t C(start)(C(state)* state, std::size_t state_size, const C(model)* model, std::int32_t which) {
  const CModel* m = model_in(model);
  if (m == nullptr || !aligned(state) || state_size != sizeof *state) return refused;
  if (which != MDHCAL_NOMINAL && which != MDHCAL_CORRECTED) return refused;
  const CState made{state_mark, rest(m->models, which == MDHCAL_CORRECTED)};
  std::memcpy(state, &made, sizeof made);
  return number(Status::ok);
}

std::int32_t C(start_ramp)(C(state)* state, std::int32_t which, Real duration_s) {
  CState s;
  if (!read_state(state, s) || (which != MDHCAL_NOMINAL && which != MDHCAL_CORRECTED)) return refused;
  const Status status = start_ramp(s.ramp, which == MDHCAL_CORRECTED, duration_s);
  std::memcpy(state, &s, sizeof s);
  return number(status);
}

std::int32_t C(advance)(C(state)* state, Real period_s) {
  CState s;
  if (!read_state(state, s)) return refused;
  const Status status = advance(s.ramp, period_s);
  std::memcpy(state, &s, sizeof s);
  return number(status);
}

std::int32_t C(default_tick_options)(const C(model)* model, C(tick_options)* options) {
  const CModel* m = model_in(model);
  if (m == nullptr || options == nullptr) return refused;
  to_c(default_tick_options(m->models.corrected), *options);
  return number(Status::ok);
}

std::int32_t C(pose_to_joints)(const C(model)* model, const C(state)* state, const C(tick_options)* options,
                               const C(pose)* base_T_flange, Real* q, C(tick_report)* report) {
  const CModel* m = model_in(model);
  CState s;
  if (m == nullptr || !read_state(state, s) || options == nullptr || base_T_flange == nullptr || q == nullptr) {
    return refused;
  }
  TickReport<Real> done{};
  return finish(pose_to_joints(m->models, s.ramp, from_c(*options), from_c(*base_T_flange), q, &done), done, report);
}

std::int32_t C(joints_to_joints)(const C(model)* model, const C(state)* state, const C(tick_options)* options,
                                 const Real* nominal_q, Real* q, C(tick_report)* report) {
  const CModel* m = model_in(model);
  CState s;
  if (m == nullptr || !read_state(state, s) || options == nullptr || nominal_q == nullptr || q == nullptr) {
    return refused;
  }
  TickReport<Real> done{};
  return finish(joints_to_joints(m->models, s.ramp, from_c(*options), nominal_q, q, &done), done, report);
}

std::int32_t C(pose_to_pose)(const C(model)* model, const C(state)* state, const C(tick_options)* options,
                             const C(pose)* base_T_flange, Real* q, C(pose)* command, C(tick_report)* report) {
  const CModel* m = model_in(model);
  CState s;
  if (m == nullptr || !read_state(state, s) || options == nullptr || base_T_flange == nullptr || q == nullptr ||
      command == nullptr) {
    return refused;
  }
  TickReport<Real> done{};
  Pose<Real> pose;
  const Status status = pose_to_pose(m->models, s.ramp, from_c(*options), from_c(*base_T_flange), q, pose, &done);
  if (status != Status::bad_input) to_c(pose, *command);
  return finish(status, done, report);
}

std::int32_t C(joint_velocities)(const C(model)* model, const Real* q, const Real* flange_velocity,
                                 const Real* max_velocity, Real* velocity) {
  const CModel* m = model_in(model);
  if (m == nullptr || q == nullptr || flange_velocity == nullptr || max_velocity == nullptr || velocity == nullptr) {
    return refused;
  }
  return number(joint_velocities(m->models.corrected, q, flange_velocity, max_velocity, velocity));
}

std::int32_t C(find_solutions)(const C(model)* model, const C(goal_options)* goal, std::int32_t restarts,
                               const C(pose)* base_T_flange, const Real* posture, C(solutions)* solutions) {
  const CModel* m = model_in(model);
  if (m == nullptr || goal == nullptr || base_T_flange == nullptr || posture == nullptr || solutions == nullptr) {
    return refused;
  }
  const SolutionOptions<Real> how{from_c(*goal), restarts};
  Solutions<Real> found;
  const Status status = find_solutions(m->models.corrected, how, from_c(*base_T_flange), posture, found);
  if (status == Status::bad_input) return refused;
  solutions->count = found.count;
  for (std::int32_t k = 0; k < found.count; ++k) {
    for (std::int32_t j = 0; j < m->models.corrected.joint_count; ++j) solutions->q[k][j] = found.q[k][j];
    solutions->distance[k] = found.distance[k];
  }
  return number(status);
}

std::int32_t C(cold_start)(const C(model)* model, const C(goal_options)* goal, std::int32_t restarts,
                           const C(pose)* base_T_flange, Real* q) {
  const CModel* m = model_in(model);
  if (m == nullptr || goal == nullptr || base_T_flange == nullptr || q == nullptr) return refused;
  const SolutionOptions<Real> how{from_c(*goal), restarts};
  return number(cold_start(m->models.corrected, how, from_c(*base_T_flange), q));
}

}  // extern "C"
