// SPDX-License-Identifier: MIT
// From other descriptions of an arm to the modified convention with Hayati's beta.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "mdhcal/arm.hpp"

namespace mdhcal::offline {

/// Neighbouring axes whose angle is below this are nearly parallel [rad]: their common normal lies far away, and
/// Hayati's beta takes its place (Hayati 1983). 5 degrees.
inline constexpr double nearly_parallel_rad = 0.08726646259971647;

/// One link in the standard (distal) convention: Rot_z(theta) Trans_z(d) Trans_x(a) Rot_x(alpha).
struct StandardLink {
  double theta_rad, d_m, a_m, alpha_rad;
};

/// A chain in the modified convention: base_T_flange = origin * A_1(q) ... A_N(q) * last_T_flange.
struct ModifiedChain {
  std::vector<Link> links;
  Frame<double> last_T_flange;
  /// What link 1 cannot express of the way from the base to the first axis, the least motion that does: the identity if
  /// the x component of the axis is zero and the axis meets the base's x axis. A base that is 1e-5 rad off such a place
  /// gives an origin of 1e-5 rad, so that poses stay where they were.
  Frame<double> origin;
};

/// A chain of N joints, each about (or along) the z axis of its own frame, from the N + 1 fixed transforms between
/// them: base_T_flange = fixed[0] Z(q_1) fixed[1] ... Z(q_N) fixed[N]. Exact for every chain: from axis i to a nearly
/// parallel axis i+1 the origin of link i stays where d_i = 0 and x points along the perpendicular dropped from there
/// to axis i+1 (beta), elsewhere x is the common normal (beta = 0). Of the two directions of x the one nearest to
/// theta_i = 0 is taken. `fixed` holds 2 to max_joints + 1 transforms with orthonormal rotations.
ModifiedChain mdh_from_chain(std::span<const Frame<double>> fixed);

/// The same from a table in the standard convention. Links whose neighbouring axes are exactly parallel or further
/// than nearly_parallel_rad from it keep their numbers (alpha and a move to the next link, the last ones into
/// last_T_flange); only nearly parallel ones are re-anchored, so that no length runs away.
ModifiedChain mdh_from_standard(std::span<const StandardLink> table);

}  // namespace mdhcal::offline
