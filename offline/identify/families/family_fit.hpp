// SPDX-License-Identifier: MIT
// One fit of a choice of families to linearised rows: variances, robust weights and coefficients together.
#pragma once

#include <optional>

#include "offline/identify/families/family_rows.hpp"
#include "offline/identify/families/family_variances.hpp"
#include "offline/identify/uncertainty.hpp"

namespace mdhcal::offline {

/// Which families enter beside the geometry.
struct FamilyChoice {
  bool gravity = false;
  std::int32_t orders = 0;  ///< of the joint functions: 0, 1 or max_orders
  bool operator==(const FamilyChoice&) const = default;
};

std::string name(const FamilyChoice& choice);

struct FamilyFitControl {
  bool robust = true;
  double floor = 0.02;      ///< least standard deviation of a scaled residual: the noise that is stated
  int rounds = 6;           ///< of weights
  int steps = 3;            ///< of the variances in each
};

struct FamilyFit {
  FamilyVariances variances;
  double log_likelihood = 0;
  Eigen::VectorXd step;              ///< of all columns of the rows, frames first; 0 for columns that have no part
  std::vector<double> weight;        ///< one a cell; of cells that have no part what they would have
  std::vector<double> error_norm;    ///< standard_error_norm() of every cell
  double scale = 0;                  ///< of one axis's scaled residual
  double parameters_used = 0;        ///< degrees of freedom that the fit took
  bool settled = false;
  Covariance covariance;             ///< joint posterior of all columns, if asked for
};

/// Fits the cells of `use` (one a cell; empty: all). Starts from `start`, whose weights may be empty.
FamilyFit fit_families(const FamilyRows& rows, const std::vector<bool>& use, const FamilyChoice& choice, const FamilyFit& start,
                       const FamilyFitControl& control, bool with_covariance = false);

/// What is left of every scalar row after a step, scaled.
Eigen::VectorXd residual_after(const FamilyRows& rows, const Eigen::VectorXd& step);

}  // namespace mdhcal::offline
