// SPDX-License-Identifier: MIT
// Restricted maximum likelihood with one prior variance a family: what `reml` is for the geometry alone (Patterson and
// Thompson 1971; Gilmour, Thompson and Cullis 1995).
#pragma once

#include <Eigen/Core>

#include <array>

#include "offline/identify/families/terms.hpp"

namespace mdhcal::offline {

/// Prior standard deviations of the families in units of their columns (0: the family has no part), and of the noise of a
/// scaled residual.
struct FamilyVariances {
  std::array<double, family_count> sd{};
  double noise = 1.0;
};

/// The bounds within which they are sought.
struct VarianceBounds {
  std::array<double, family_count> most{};
  double least_noise = 0.02;
};

/// Rows from which the frames are projected out: y = columns u + noise, and `silent` further rows that read 0 of nothing
/// but noise.
struct ProjectedRows {
  Eigen::MatrixXd columns;
  Eigen::VectorXd y;
  std::vector<TermFamily> family;  ///< one a column, each family's columns side by side
  double silent = 0;
};

/// What the rows say at given variances.
struct FamilySolution {
  FamilyVariances variances;
  double log_likelihood = 0;
  Eigen::VectorXd u;                ///< best linear unbiased prediction of the coefficients
  double effective_parameters = 0;  ///< trace of the hat matrix of the columns
  Eigen::MatrixXd whitened;         ///< L^-1 columns, L the Cholesky factor of the rows' covariance
};

/// At most `steps` steps of the average-information iteration on the logarithms of the variances, from `start`. `settled`,
/// if not null, receives whether the last step changed no standard deviation by more than 3 %.
FamilySolution maximise_likelihood(const ProjectedRows& rows, const FamilyVariances& start, const VarianceBounds& bounds, int steps,
                                   bool* settled = nullptr);

}  // namespace mdhcal::offline
