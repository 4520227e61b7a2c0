// SPDX-License-Identifier: MIT
// The rows of all families, linearised once: candidates are choices of their columns, folds choices of their cells.
#pragma once

#include <Eigen/Core>

#include <array>
#include <vector>

#include "offline/identify/reduction.hpp"

namespace mdhcal::offline {

/// Rows of one pose and target, which share what the model does not hold of them: they count as one, at their mean.
struct Cell {
  Eigen::Index first = 0;        ///< its first scalar row
  Eigen::Index count = 0;        ///< 1, 3 or 6 scalar rows
  std::uint32_t pose = 0;
  std::array<double, 3> scale{}; ///< of the position's residuals, or of a distance's [1/mm]
};

struct FamilyRows {
  std::vector<Cell> cells;
  std::size_t poses = 0;
  Eigen::MatrixXd frames;        ///< scalar rows x frame columns of the layout
  Eigen::MatrixXd columns;       ///< scalar rows x geometry and terms, in units of their priors
  Eigen::VectorXd residual;      ///< predicted minus measured, scaled
  Eigen::VectorXd x0;            ///< the deviations at which it was linearised
  std::vector<TermFamily> family;    ///< one a column
  std::vector<std::int32_t> order;  ///< likewise: the order of a joint function, else 0
};

/// Linearises the selected rows at `at`. Within a cell, rows whose robust weight in `selection` is below the outlier weight
/// count only if all of them are.
FamilyRows family_rows(const Dataset& data, const Selection& selection, const Layout& layout, const Estimate& at, double noise_mm);

}  // namespace mdhcal::offline
