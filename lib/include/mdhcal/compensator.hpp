// SPDX-License-Identifier: MIT
#pragma once

#include "mdhcal/inverse.hpp"
#include "mdhcal/kinematics.hpp"

namespace mdhcal {

/// What a compensator holds constant: the two models. Shared by any number of loops; plain data.
template <class Real>
struct CompensatorModel {
  Arm<Real> nominal;    ///< the geometry that the controller believes
  Arm<Real> corrected;  ///< the geometry as it was calibrated; joints, signs, couplings and limits as in `nominal`
};

/// The part of a loop that changes: how far the ramp between the models has come. Plain data; one a loop.
template <class Real>
struct CompensatorState {
  Real progress;  ///< 0: nominal, 1: corrected; between them during a ramp, in proportion to time
  Real target;    ///< where the ramp goes, 0 or 1
  Real rate;      ///< of the progress [1/s]
};

/// Prepares both models from one set of joints. Returns ok, bad_input (a geometry does not pass check_geometry(), or the two differ
/// in joint count, kinds, signs or couplings), bad_environment (check_environment()); `model` untouched unless ok.
Status make_compensator(const Geometry& nominal, const Geometry& corrected, CompensatorModel<double>& model) noexcept;
Status make_compensator(const Geometry& nominal, const Geometry& corrected, CompensatorModel<float>& model) noexcept;

/// A state at rest: on the corrected model if `corrected` is true, else on the nominal one.
CompensatorState<double> rest(const CompensatorModel<double>& model, bool corrected) noexcept;
CompensatorState<float> rest(const CompensatorModel<float>& model, bool corrected) noexcept;

/// Starts a ramp to the corrected or the nominal model that takes `duration_s` (0 ... 1e6) from one end to the other; from
/// the middle of another ramp it goes on from there. The share of the corrected model is p^2 (3 - 2 p) of the progress
/// p, so that the ramp begins and ends without a change of velocity. Returns ok or bad_input (state untouched).
Status start_ramp(CompensatorState<double>& state, bool corrected, double duration_s) noexcept;
Status start_ramp(CompensatorState<float>& state, bool corrected, float duration_s) noexcept;

/// Lets the ramp go on by one tick of `period_s` (0 ... 1e3). Returns ok or bad_input (state untouched).
Status advance(CompensatorState<double>& state, double period_s) noexcept;
Status advance(CompensatorState<float>& state, float period_s) noexcept;

/// First form, pose -> joints. Moves the joints q by one tick() towards base_T_flange on the model that the ramp has
/// come to: between the two that is an arm whose every parameter is between theirs, so nothing jumps. Returns as tick().
Status pose_to_joints(const CompensatorModel<double>& model, const CompensatorState<double>& state,
                      const TickOptions<double>& options, const Pose<double>& base_T_flange, double* q,
                      TickReport<double>* report = nullptr) noexcept;
Status pose_to_joints(const CompensatorModel<float>& model, const CompensatorState<float>& state,
                      const TickOptions<float>& options, const Pose<float>& base_T_flange, float* q,
                      TickReport<float>* report = nullptr) noexcept;

/// Second form, nominal joints -> corrected joints: what the controller's own inverse gave, made true. `nominal_q` says
/// which pose was meant; `q` holds the last corrected joints and receives the new ones (start it with nominal_q).
/// Returns as tick(), on bad_input q is untouched.
Status joints_to_joints(const CompensatorModel<double>& model, const CompensatorState<double>& state,
                        const TickOptions<double>& options, const double* nominal_q, double* q,
                        TickReport<double>* report = nullptr) noexcept;
Status joints_to_joints(const CompensatorModel<float>& model, const CompensatorState<float>& state,
                        const TickOptions<float>& options, const float* nominal_q, float* q,
                        TickReport<float>* report = nullptr) noexcept;

/// Third form, pose -> the pose to command to a controller that keeps its nominal model, so that the arm as it is reaches
/// base_T_flange. `q` holds the last joints and receives the new ones, as in pose_to_joints(). Returns as tick();
/// `command` is written unless bad_input.
Status pose_to_pose(const CompensatorModel<double>& model, const CompensatorState<double>& state,
                    const TickOptions<double>& options, const Pose<double>& base_T_flange, double* q,
                    Pose<double>& command, TickReport<double>* report = nullptr) noexcept;
Status pose_to_pose(const CompensatorModel<float>& model, const CompensatorState<float>& state,
                    const TickOptions<float>& options, const Pose<float>& base_T_flange, float* q,
                    Pose<float>& command, TickReport<float>* report = nullptr) noexcept;

/// Joint velocities [rad/s or m/s] at the readings q for a velocity of the flange in the base frame: of its origin [m/s],
/// then the angular one [rad/s]. Damped least squares with the least damping that keeps every |velocity| within
/// `max_velocity` (> 0); redundant joints get the smallest velocities. Returns ok (the flange's velocity is met to
/// 1e-9 relative, float 1e-4); near_singular, step_limited, or out_of_reach (an arm with fewer joints than the velocity
/// needs), all usable and short of it; bad_input (velocities untouched).
Status joint_velocities(const Arm<double>& arm, const double* q, const double* flange_velocity,
                        const double* max_velocity, double* velocity) noexcept;
Status joint_velocities(const Arm<float>& arm, const float* q, const float* flange_velocity,
                        const float* max_velocity, float* velocity) noexcept;

}  // namespace mdhcal
