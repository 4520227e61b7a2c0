// SPDX-License-Identifier: MIT
#pragma once

#include "mdhcal/inverse.hpp"

namespace mdhcal {

/// The most solutions that one call returns.
inline constexpr std::int32_t max_solutions = 16;
/// The most restarts that one call may use.
inline constexpr std::int32_t max_restarts = 400;

/// How to look for solutions. Take default_solution_options() and change what matters.
template <class Real>
struct SolutionOptions {
  GoalOptions<Real> goal;  ///< tolerances and task; the weights are not used
  std::int32_t restarts;   ///< 0 ... max_restarts: how many, beyond the closed form's values; 0: none
};

/// What was found, nearest to the posture first.
template <class Real>
struct Solutions {
  std::int32_t count;                     ///< 0 ... max_solutions
  ArmFamily family;
  Real q[max_solutions][max_joints];      ///< readings [rad] or [m], each turn the allowed one nearest to the posture
  Real distance[max_solutions];           ///< largest joint difference from the posture [rad, or lengths of the arm]
};

/// 0 restarts for an arm with a closed form, else 100.
SolutionOptions<double> default_solution_options(const Arm<double>& arm) noexcept;
SolutionOptions<float> default_solution_options(const Arm<float>& arm) noexcept;

/// The family whose closed form gives starting values: axes count as parallel within 5 degrees and as meeting within
/// 0.05 of the reach, since the starting values are refined on the arm as it is.
ArmFamily family_of(const Arm<double>& arm) noexcept;
ArmFamily family_of(const Arm<float>& arm) noexcept;

/// Every solution of the pose within the joint limits, counted modulo full turns: the closed form of the family (Paden 1985;
/// Kahan; Elias, Wen 2022), which treats the arm as if its axes were exactly parallel and met exactly, gives starting values;
/// further ones are set on both sides of every nearly double root, and, where a solution found is near a singularity, at the
/// posture and all around for a joint that the singularity leaves free. Each is refined on the arm as it is, and solutions
/// within 1e-3 (float 5e-3) of each other in every joint are one. Each joint is on the allowed turn nearest to the posture; a
/// value beyond a limit by a rounding or the tolerance is put on the limit, if the pose is met there. An arm with more joints
/// than the task needs has a solution a starting value.
/// Returns ok (count > 0), out_of_reach (none was found; count 0), or bad_input (as tick(); also a posture that is not
/// finite or beyond max_reading; `solutions` untouched). Bounded: refinements of at most 64 evaluations of the arm and a
/// regular tick's, 25 of them at regular poses, 273 with a straight wrist, 529 with the wrist on axis 1, 777 with both, besides
/// the restarts.
Status find_solutions(const Arm<double>& arm, const SolutionOptions<double>& options,
                      const Pose<double>& base_T_flange, const double* posture, Solutions<double>& solutions) noexcept;
Status find_solutions(const Arm<float>& arm, const SolutionOptions<float>& options, const Pose<float>& base_T_flange,
                      const float* posture, Solutions<float>& solutions) noexcept;

/// Cold start: a solution of the pose for the readings q[joint_count], in place: the nearest of those that the closed form's
/// values, on both sides of nearly double roots, lead to. Only if there is none are the readings themselves and the further
/// values tried, then options.restarts restarts (max_restarts where a start has to be found) until one leads to a solution.
/// Returns as find_solutions(); q is untouched unless ok.
Status cold_start(const Arm<double>& arm, const SolutionOptions<double>& options, const Pose<double>& base_T_flange,
                  double* q) noexcept;
Status cold_start(const Arm<float>& arm, const SolutionOptions<float>& options, const Pose<float>& base_T_flange,
                  float* q) noexcept;

}  // namespace mdhcal
