// SPDX-License-Identifier: MIT
#include "mdhcal/compensator.hpp"

#include "arm/chain.hpp"
#include "mdhcal/environment.hpp"
#include "number/real.hpp"
#include "arm/rotation.hpp"
#include "inverse/svd.hpp"
#include "number/compare.hpp"

namespace mdhcal {

namespace {

// A ramp of no time at all: the next advance() is there, however short its period [1/s].
constexpr Real fastest = Real(1e30);

bool same_joints(const Arm<Real>& a, const Arm<Real>& b) {
  if (a.joint_count != b.joint_count || a.prismatic_mask != b.prismatic_mask) return false;
  for (std::int32_t i = 0; i < a.joint_count; ++i) {
    for (std::int32_t j = 0; j < a.joint_count; ++j) {
      if (magnitude(a.map[i][j] - b.map[i][j]) > Real{0}) return false;
    }
  }
  return true;
}

Real between(Real a, Real b, Real share) { return a + share * (b - a); }

// The angle between two angles that are near to each other, by its sine and cosine.
void angle_between(Real sine_a, Real cosine_a, Real sine_b, Real cosine_b, Real share, Real& sine, Real& cosine) {
  const Real s = between(sine_a, sine_b, share);
  const Real c = between(cosine_a, cosine_b, share);
  const Real norm = square_root(s * s + c * c);
  // Opposite angles have no middle; a calibration is never that far from its drawing.
  sine = norm > Real(0.1) ? s / norm : sine_b;
  cosine = norm > Real(0.1) ? c / norm : cosine_b;
}

// The arm that the ramp has come to: one of the two, or `room` filled with the one between.
const Arm<Real>& current(const CompensatorModel<Real>& model, const CompensatorState<Real>& state, Arm<Real>& room) {
  const Real p = state.progress;
  if (!(p > Real{0})) return model.nominal;
  if (!(p < Real{1})) return model.corrected;
  const Real share = p * p * (Real{3} - Real{2} * p);
  room = model.corrected;
  for (std::int32_t i = 0; i < room.joint_count; ++i) {
    const ArmLink<Real>& a = model.nominal.link[i];
    const ArmLink<Real>& b = model.corrected.link[i];
    ArmLink<Real>& link = room.link[i];
    angle_between(a.sin_alpha, a.cos_alpha, b.sin_alpha, b.cos_alpha, share, link.sin_alpha, link.cos_alpha);
    angle_between(a.sin_beta, a.cos_beta, b.sin_beta, b.cos_beta, share, link.sin_beta, link.cos_beta);
    link.a_m = between(a.a_m, b.a_m, share);
    link.d_m = between(a.d_m, b.d_m, share);
    link.theta_rad = between(a.theta_rad, b.theta_rad, share);
  }
  room.reach_m = between(model.nominal.reach_m, model.corrected.reach_m, share);
  return room;
}

bool valid(const CompensatorState<Real>& state) {
  return within(Real{0}, state.progress, Real{1}) && within(Real{0}, state.target, Real{1}) &&
         within(Real{0}, state.rate, fastest);
}

}  // namespace

Status make_compensator(const Geometry& nominal, const Geometry& corrected, CompensatorModel<Real>& model) noexcept {
  const Status environment = check_environment();
  if (environment != Status::ok) return environment;
  if (check_geometry(nominal) != Status::ok || check_geometry(corrected) != Status::ok) return Status::bad_input;
  CompensatorModel<Real> made;
  Status status = make_arm(nominal, made.nominal);
  if (status == Status::ok) status = make_arm(corrected, made.corrected);
  if (status != Status::ok) return status;
  if (!same_joints(made.nominal, made.corrected)) return Status::bad_input;
  model = made;
  return Status::ok;
}

CompensatorState<Real> rest(const CompensatorModel<Real>&, bool corrected) noexcept {
  const Real end = corrected ? Real{1} : Real{0};
  return {end, end, Real{0}};
}

Status start_ramp(CompensatorState<Real>& state, bool corrected, Real duration_s) noexcept {
  if (!valid(state) || !within(Real{0}, duration_s, Real(1e6))) return Status::bad_input;
  state.target = corrected ? Real{1} : Real{0};
  state.rate = duration_s > Real(1e-9) ? Real{1} / duration_s : fastest;
  return Status::ok;
}

Status advance(CompensatorState<Real>& state, Real period_s) noexcept {
  if (!valid(state) || !within(Real{0}, period_s, Real(1e3))) return Status::bad_input;
  const Real step = state.rate * period_s;
  if (state.progress < state.target) {
    state.progress = state.target - state.progress > step ? state.progress + step : state.target;
  } else if (state.progress > state.target) {
    state.progress = state.progress - state.target > step ? state.progress - step : state.target;
  }
  return Status::ok;
}

Status pose_to_joints(const CompensatorModel<Real>& model, const CompensatorState<Real>& state,
                      const TickOptions<Real>& options, const Pose<Real>& base_T_flange, Real* q,
                      TickReport<Real>* report) noexcept {
  if (!valid(state)) return Status::bad_input;
  Arm<Real> room;
  return tick(current(model, state, room), options, base_T_flange, q, report);
}

Status joints_to_joints(const CompensatorModel<Real>& model, const CompensatorState<Real>& state,
                        const TickOptions<Real>& options, const Real* nominal_q, Real* q,
                        TickReport<Real>* report) noexcept {
  Pose<Real> meant;
  const Status status = forward(model.nominal, nominal_q, meant);
  return status == Status::ok ? pose_to_joints(model, state, options, meant, q, report) : status;
}

Status pose_to_pose(const CompensatorModel<Real>& model, const CompensatorState<Real>& state,
                    const TickOptions<Real>& options, const Pose<Real>& base_T_flange, Real* q, Pose<Real>& command,
                    TickReport<Real>* report) noexcept {
  const Status status = pose_to_joints(model, state, options, base_T_flange, q, report);
  if (status == Status::bad_input) return status;
  const Status reached = forward(model.nominal, q, command);
  return reached == Status::ok ? status : reached;
}

Status joint_velocities(const Arm<Real>& arm, const Real* q, const Real* flange_velocity, const Real* max_velocity,
                        Real* velocity) noexcept {
  if (!readings_valid(arm, q)) return Status::bad_input;
  const std::int32_t joints = arm.joint_count;
  for (int k = 0; k < 6; ++k) {
    if (!within(Real(-1e6), flange_velocity[k], Real(1e6))) return Status::bad_input;
  }
  for (std::int32_t j = 0; j < joints; ++j) {
    if (!within(Real{0}, max_velocity[j], Real(1e6)) || !(max_velocity[j] > Real{0})) return Status::bad_input;
  }
  const Real length_m = arm.reach_m > Real(1e-6) ? arm.reach_m : Real{1};
  Frame<Real> frame;
  Jacobian<Real> jacobian;
  evaluate(arm, q, frame, jacobian);
  to_readings(arm, jacobian);
  SingularBasis basis;
  Real wanted[6];
  for (int k = 0; k < 6; ++k) wanted[k] = k < 3 ? flange_velocity[k] / length_m : flange_velocity[k];
  Real unit[max_joints];
  for (std::int32_t j = 0; j < joints; ++j) {
    unit[j] = ((arm.prismatic_mask >> static_cast<std::uint32_t>(j)) & 1U) != 0U ? length_m : Real{1};
    for (int k = 0; k < 6; ++k) basis.us[j][k] = jacobian.column[j][k] * unit[j] / (k < 3 ? length_m : Real{1});
  }
  decompose(basis, joints);
  const std::int32_t rank = joints < 6 ? joints : 6;
  constexpr Real lost = sizeof(Real) == sizeof(double) ? Real(1e-13) : Real(1e-6);
  Real along[max_joints];
  for (std::int32_t k = 0; k < rank; ++k) {
    along[k] = basis.s[k] > lost * basis.s[0] ? dot6(basis.us[k], wanted) : Real{0};
  }
  // The least damping, to within a factor of two, that keeps the limits.
  Real damping = 0;
  Real result[max_joints];
  for (int round = 0; round < 80; ++round) {
    bool fits = true;
    for (std::int32_t j = 0; j < joints; ++j) {
      Real sum = 0;
      for (std::int32_t k = 0; k < rank; ++k) {
        const Real square = basis.s[k] * basis.s[k] + damping;
        if (square > Real{0}) sum += along[k] / square * basis.v[k][j];
      }
      result[j] = sum * unit[j];
      if (!(magnitude(result[j]) <= max_velocity[j])) fits = false;
    }
    if (fits) break;
    damping = damping > Real{0} ? Real{2} * damping : Real(1e-12);
  }
  Real missed = 0;
  Real size = 0;
  for (int k = 0; k < 6; ++k) {
    Real reached = 0;
    for (std::int32_t j = 0; j < joints; ++j) reached += jacobian.column[j][k] * result[j];
    if (k < 3) reached /= length_m;
    missed += (reached - wanted[k]) * (reached - wanted[k]);
    size += wanted[k] * wanted[k];
  }
  for (std::int32_t j = 0; j < joints; ++j) {
    // Eighty doublings fit whatever the bounds above allow; the last word is the limit all the same.
    const Real limit = max_velocity[j];
    velocity[j] = result[j] > limit ? limit : (result[j] < -limit ? -limit : result[j]);
  }
  constexpr Real met = sizeof(Real) == sizeof(double) ? Real(1e-9) : Real(1e-4);
  if (missed <= met * met * size) return Status::ok;
  if (basis.s[rank - 1] < Real(0.01)) return Status::near_singular;
  return damping > Real{0} ? Status::step_limited : Status::out_of_reach;
}

}  // namespace mdhcal
