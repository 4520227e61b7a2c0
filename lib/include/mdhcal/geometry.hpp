// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

namespace mdhcal {

/// The most joints that an arm may have.
inline constexpr std::size_t max_joints = 8;

/// A pose: rotation as a unit quaternion w, x, y, z with w >= 0, and position [m]. Named frame_T_frame at its use.
template <class Real>
struct Pose {
  Real quaternion[4];   ///< w, x, y, z [1]
  Real position_m[3];   ///< [m]
};

/// What a joint moves.
enum class JointKind : std::int32_t {
  revolute = 0,   ///< turns about z: the joint coordinate adds to theta [rad]
  prismatic = 1,  ///< slides along z: the joint coordinate adds to d [m]
};

/// Which closed form holds for an arm's nominal geometry, and with it what posture (shoulder, elbow, wrist) means on it:
/// family_of() (mdhcal/solutions.hpp) judges it, the blob declares it. Six turning joints, but for `general`.
enum class ArmFamily : std::int32_t {
  general = 0,          ///< none: solutions come from restarts
  spherical_wrist = 1,  ///< axes 2 and 3 parallel, axes 4, 5 and 6 meeting in a point
  parallel_axes = 2,    ///< axes 2, 3 and 4 parallel, axes 5 and 6 meeting
};

/// Modified Denavit-Hartenberg parameters of one link with Hayati's beta:
/// A = Rot_x(alpha) Trans_x(a) Rot_z(theta) Trans_z(d) Rot_y(beta)   (Li 2022, Eq. 1).
struct Link {
  double alpha_rad;  ///< twist alpha_{i-1} [rad]
  double a_m;        ///< link length a_{i-1} [m]
  double theta_rad;  ///< offset added to the joint coordinate of a revolute joint [rad]
  double d_m;        ///< link offset d_i [m]
  double beta_rad;   ///< rotation about y after the link, free where axis i+1 is (nearly) parallel [rad]
};

/// How a reading of the controller becomes a joint coordinate, and where it may go.
struct Joint {
  JointKind kind;
  std::int32_t sign;        ///< direction of the reading, +1 or -1
  std::int32_t has_min;     ///< 1 if `min` holds, else 0
  std::int32_t has_max;     ///< 1 if `max` holds, else 0
  double min;               ///< lower limit of the reading [rad] or [m]
  double max;               ///< upper limit of the reading [rad] or [m]
  double coupling[max_joints]; ///< ratio of each other joint's reading that is added; the own entry is 0
};

/// The geometry of one arm: base_T_flange(q) = A_1(q) ... A_N(q) flange   (Li 2022, Eq. 3 with its factors).
/// Joint coordinate i = sign_i q_i + sum_j coupling_ij q_j. Plain data; check_geometry() says whether it is valid.
struct Geometry {
  std::int32_t joint_count;     ///< 1 ... max_joints
  std::int32_t reserved;        ///< 0
  Link link[max_joints];        ///< base to flange; entries from joint_count on are zero
  Joint joint[max_joints];      ///< likewise
  Pose<double> last_T_flange;   ///< fixed transform after the last link
};

/// Bounds inside which a geometry is valid: lengths in [-max_length_m, max_length_m], angles in [-max_angle_rad,
/// max_angle_rad], coupling ratios in [-max_coupling, max_coupling], readings' limits in +-max_reading.
inline constexpr double max_length_m = 1000.0;
inline constexpr double max_angle_rad = 12.566370614359172;  // two turns
inline constexpr double max_coupling = 100.0;
inline constexpr double max_reading = 1000.0;

}  // namespace mdhcal
