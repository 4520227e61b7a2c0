// SPDX-License-Identifier: MIT
// Rows that are not independent: a random effect a pose, and one a pose and target, by restricted maximum likelihood.
#pragma once

#include <Eigen/Core>

#include "offline/identify/reduction.hpp"

namespace mdhcal::offline {

/// Rows of one pose, one axis: scaled, of equal variance before their robust weights.
struct PoseBlock {
  std::vector<std::size_t> selected;  ///< indices into Selection::rows, each of a positive weight, ordered by target
  std::vector<std::uint32_t> target;  ///< likewise
};

/// The selected rows that measure a position, by pose; those of no weight are left out.
std::vector<PoseBlock> pose_blocks(const Dataset& data, const Selection& selection);

/// Multiplies `rows` (one a row of the block) by V^(-1/2) for V = own diag(1 / w) + by_target 1 1^T (within a target)
/// + by_pose 1 1^T: two rank-one steps, each orthogonally invariant and without forming V. Returns log det V but for the
/// weights' part, which no share changes.
double whiten(const SharedError& shared, const PoseBlock& block, const std::vector<double>& robust_weight,
              Eigen::Ref<Eigen::MatrixXd> rows);

/// Sets `selection.pose`, and `selection.shared` to the shares of greatest restricted likelihood at `at`: deviations are normal
/// with an unknown variance, base and targets are projected out (Patterson and Thompson 1971). Nothing is shared where no
/// pose has a second row. At most 300 poses, evenly taken, are looked at.
void set_shared_error(const Dataset& data, const Layout& layout, const Estimate& at, double noise_mm, Selection& selection);

/// How much of the rows counts as independent, in (0, 1]: rows of one pose inform of what they share like 1^T V^-1 1 rows (the
/// design effect, Kish 1965). 1 where nothing is shared.
double independent_share(const Dataset& data, const Selection& selection);

}  // namespace mdhcal::offline
