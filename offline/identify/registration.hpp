// SPDX-License-Identifier: MIT
// Closed-form starting values of the base frame and the target points.
#pragma once

#include <vector>

#include "offline/identify/model.hpp"

namespace mdhcal::offline {

/// The rigid transform b_T_a that takes points a to points b with the least squared error, by SVD with the
/// determinant guard against reflections (Arun, Huang, Blostein 1987; Umeyama 1991; Li 2022, Eq. 17). `weight` may be
/// empty. With fewer than three points off a line the rotation is one of those that fit equally well.
Frame<double> rigid_fit(const std::vector<Vector3>& a, const std::vector<Vector3>& b,
                        const std::vector<double>& weight);

/// The rotation that is nearest to all of the given ones in the mean square of their matrices' differences (chordal mean;
/// Moakher 2002). The position is zero; of no rotations the mean is the identity.
Frame<double> mean_rotation(const std::vector<Frame<double>>& rotations);

/// Starting values, best first is not promised: the caller refines each and keeps the one that fits best. Candidates
/// are, as far as base and targets are to be fitted: the joint linear equations R^T m - R^T t = p_i + R_i flange_p with
/// R projected on SO(3); target points from equal distances between pairs of poses (Li 2022, Eq. 21), then rigid_fit; a
/// draw wire's fixed ends, each located in the base frame by its lengths, then rigid_fit; rigid_fit with the nominal
/// targets.
std::vector<Estimate> starting_values(const Dataset& data, const std::vector<std::size_t>& rows,
                                      const Layout& layout, const Estimate& nominal);

}  // namespace mdhcal::offline
