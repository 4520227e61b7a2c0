// SPDX-License-Identifier: MIT
#pragma once

#include "mdhcal/calibrated_arm.hpp"
#include "mdhcal/kinematics.hpp"
#include "mdhcal/pose.hpp"
#include "mdhcal/velocities.hpp"

namespace mdhcal {

/// Where the target poses of a loop are meant: the pose of the tool in the user frame.
template <class Real>
struct Frames {
  Pose<Real> base_T_user;    ///< the user (work piece) frame in the robot's base frame
  Pose<Real> flange_T_tool;  ///< the tool centre point in the flange frame
};

/// Both frames the identity: base_T_flange.
template <class Real>
constexpr Frames<Real> identity_frames() noexcept {
  return {identity_pose<Real>(), identity_pose<Real>()};
}

/// The parameters of an arm and its frames that a ramp moves: of each link alpha, a, theta, d, beta; the joints' limits, the
/// reach, the payload; flange, tool and user frame as quaternion and position.
template <class Real>
struct RampParameters {
  Real link[max_joints][5];
  Real min[max_joints], max[max_joints], reach_m, payload_kg;
  Pose<Real> pose[3];
};

/// How the terms of the transmission (joint functions, sag) come and go within a ramp.
template <class Real>
struct TermsRamp {
  ArmTerms<Real> before;  ///< the terms that the arm has until `ticks`, then the goal's
  std::int32_t has_before;
  std::uint32_t ticks;    ///< 0: the goal's from the beginning; ticks_total: they are the goal's, or the goal has none
  Real share, rate;       ///< their share and its change a tick, as the ramp began
};

/// One loop's compensator: the arm that the controller believes and the one that the loop is on, which a ramp moves. It
/// holds copies, but for the table of joint functions: a CalibratedArm that has some may change or go when refers_to() says no.
/// Plain data, some 10 KiB (float 5); one a loop.
/// Its functions are for the thread that runs the loop: none of them locks, and none may run beside another on the same
/// compensator. What prepares a new calibration in another thread hands a finished CalibratedArm over to the loop's thread
/// (a pointer in an atomic will do), which then calls start_ramp().
template <class Real>
struct Compensator {
  std::uint32_t mark;          ///< what start_at_rest() leaves; every function refuses another with bad_input
  std::uint32_t ticks_done;    ///< of the ramp
  std::uint32_t ticks_total;   ///< equal to ticks_done: at rest
  std::uint32_t ticks_fading;  ///< in which the velocity that the ramp began with goes to zero
  Arm<Real> nominal;           ///< flange, no tool
  Arm<Real> goal_arm;          ///< where the ramp goes; flange, no tool
  Frames<Real> goal_frames;
  RampParameters<Real> offset; ///< present less goal, as the ramp began
  RampParameters<Real> rate;   ///< its change a tick, as the ramp began
  TermsRamp<Real> terms;
  Real payload_kg;             ///< the payload that was asked for
  std::int32_t has_payload;    ///< 1 if one was
  Arm<Real> arm;               ///< the arm of this tick, the tool's frame in the place of the flange's
  Frames<Real> frames;         ///< the frames of this tick
  std::int32_t has_frames;     ///< 0 if both are the identity
};

/// Puts a loop at rest on one model, with identity frames. Returns ok or bad_input (compensator untouched).
Status start_at_rest(const CalibratedArm<double>& arm, Model model, Compensator<double>& compensator) noexcept;
Status start_at_rest(const CalibratedArm<float>& arm, Model model, Compensator<float>& compensator) noexcept;

/// Starts a ramp of `ticks` ticks to a model of the same robot: of this blob, or of a new one. Every parameter (links,
/// flange, limits that both have, frames) goes from where it is, at the velocity that it has, to its goal along a quintic,
/// where it comes to rest: offset (1 - 10 s^3 + 15 s^4 - 6 s^5) + rate (s - 6 s^3 + 8 s^4 - 3 s^5), so that a ramp may be
/// turned back or started anew in the middle of another without a jump of velocity. With 0 ticks it is there at once.
/// Terms of the transmission that one of the two models has come or go as a whole along the quintic; where the two have
/// different ones, those of the first go in the first half and those of the goal come in the second.
/// The velocity of the ramp before fades within what that had left, so that nothing overshoots by more than 0.15 of it.
/// Returns ok or bad_input (the joints differ in count, kinds, signs or couplings; compensator untouched).
Status start_ramp(Compensator<double>& compensator, const CalibratedArm<double>& arm, Model model,
                  std::uint32_t ticks) noexcept;
Status start_ramp(Compensator<float>& compensator, const CalibratedArm<float>& arm, Model model,
                  std::uint32_t ticks) noexcept;

/// The same to other frames, on the model that the loop is on or on its way to.
Status start_frame_ramp(Compensator<double>& compensator, const Frames<double>& frames, std::uint32_t ticks) noexcept;
Status start_frame_ramp(Compensator<float>& compensator, const Frames<float>& frames, std::uint32_t ticks) noexcept;

/// The same to another payload [kg], which from then on is that of every model that knows what a payload does. Returns ok or
/// bad_input (as set_payload(); compensator untouched).
Status start_payload_ramp(Compensator<double>& compensator, double payload_kg, std::uint32_t ticks) noexcept;
Status start_payload_ramp(Compensator<float>& compensator, float payload_kg, std::uint32_t ticks) noexcept;

/// Whether the loop is on this arm's joint functions or on the way to or from them: until then it must not change.
template <class Real>
constexpr bool refers_to(const Compensator<Real>& compensator, const CalibratedArm<Real>& arm) noexcept {
  const JointFunctionTable* table = &arm.functions;
  return compensator.arm.terms.functions == table || compensator.goal_arm.terms.functions == table;
}

/// One tick of the ramp; nothing at rest. Returns ok or bad_input.
Status advance_ramp(Compensator<double>& compensator) noexcept;
Status advance_ramp(Compensator<float>& compensator) noexcept;

/// Ticks until the compensator is at rest; 0: it is.
template <class Real>
constexpr std::uint32_t ramp_ticks_left(const Compensator<Real>& compensator) noexcept {
  return compensator.ticks_total - compensator.ticks_done;
}

/// First form, pose -> joints. Moves the joints q by one tick() towards user_T_tool (base_T_flange with identity frames)
/// on the arm that the ramp has come to. Returns as tick().
Status pose_to_joints(const Compensator<double>& compensator, const TickOptions<double>& options,
                      const Pose<double>& user_T_tool, double* q, TickReport<double>* report = nullptr) noexcept;
Status pose_to_joints(const Compensator<float>& compensator, const TickOptions<float>& options,
                      const Pose<float>& user_T_tool, float* q, TickReport<float>* report = nullptr) noexcept;

/// Second form, nominal joints -> corrected joints: what the controller's own inverse gave, made true. The corrected joints
/// follow `nominal_q`, their branch and their turn: tick() seeks them from nominal_q, and q (in: last corrected joints, to
/// begin with nominal_q; out: the new ones) goes there in a straight line of joints as far as the step limit lets it. A last
/// joint whose nominal reading has wrapped by full turns is counted from the new turn. Returns as tick().
Status joints_to_joints(const Compensator<double>& compensator, const TickOptions<double>& options,
                        const double* nominal_q, double* q, TickReport<double>* report = nullptr) noexcept;
Status joints_to_joints(const Compensator<float>& compensator, const TickOptions<float>& options, const float* nominal_q,
                        float* q, TickReport<float>* report = nullptr) noexcept;

/// Third form, pose -> the pose to command to a controller that keeps its nominal model (with the same frames), so that the
/// arm as it is reaches user_T_tool. `q` as in pose_to_joints(). Returns as tick(); `command` is written unless bad_input.
Status pose_to_pose(const Compensator<double>& compensator, const TickOptions<double>& options,
                    const Pose<double>& user_T_tool, double* q, Pose<double>& command,
                    TickReport<double>* report = nullptr) noexcept;
Status pose_to_pose(const Compensator<float>& compensator, const TickOptions<float>& options,
                    const Pose<float>& user_T_tool, float* q, Pose<float>& command,
                    TickReport<float>* report = nullptr) noexcept;

/// What the ramp itself does to the tool at the joints q: velocity of its origin [m], angular velocity [rad], both a tick and
/// in the base frame, less those of the user frame's motion; but for what the change of the geometry does to the sag, some
/// thousandth of it. Zero at rest. Returns ok or bad_input.
Status ramp_motion(const Compensator<double>& compensator, const double* q, double* motion) noexcept;
Status ramp_motion(const Compensator<float>& compensator, const float* q, float* motion) noexcept;

/// joint_velocities() on the arm of this tick for a velocity of the tool in the user frame's axes, the ramp's own motion taken
/// out of it. `period_s` is the loop's, > 0. Returns and errors as joint_velocities().
Status joint_velocities(const Compensator<double>& compensator, const double* q, const double* tool_velocity,
                        double period_s, const JointRateLimits<double>& limits, double* velocity) noexcept;
Status joint_velocities(const Compensator<float>& compensator, const float* q, const float* tool_velocity,
                        float period_s, const JointRateLimits<float>& limits, float* velocity) noexcept;

}  // namespace mdhcal
