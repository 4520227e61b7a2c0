// SPDX-License-Identifier: MIT
// Optimal experimental design by exchange: which of many candidate poses to measure.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace mdhcal::offline {

/// What makes a set of poses good. M is its information matrix: measurements and prior together.
enum class Criterion : std::int32_t {
  d,         ///< largest det M: the smallest volume of uncertainty
  a,         ///< smallest mean variance of the parameters of interest
  e,         ///< largest smallest eigenvalue of M: the best worst direction
  position,  ///< smallest mean variance of the predicted positions (I-optimal)
};

/// The experiment. Rows are scaled by 1 / standard deviation of the measurement; columns are the unknowns.
struct Experiment {
  Eigen::MatrixXd rows;          ///< `rows_per_pose` rows a candidate
  Eigen::Index rows_per_pose = 3;
  Eigen::VectorXd prior;         ///< 1 / prior standard deviation of each unknown, >= 0
  Eigen::Index of_interest = 0;  ///< unknowns from this column on count in criterion `a`
  Eigen::MatrixXd targets;       ///< rows of the predictions that count in `position`

  std::size_t candidates() const { return static_cast<std::size_t>(rows.rows() / rows_per_pose); }
};

/// Upper triangle R with M = R^T R for the chosen candidates, from the QR decomposition of their rows and the prior.
Eigen::MatrixXd information_factor(const Experiment& experiment, const std::vector<std::size_t>& chosen);

/// The criterion's value for an information factor, larger is better: log det M, or minus the sum of variances, or the
/// smallest eigenvalue of M.
double value(const Experiment& experiment, Criterion criterion, const Eigen::MatrixXd& factor);

/// Root of the mean squared standard deviation of each row of `rows` taken `rows_per_pose` at a time: one number a
/// candidate, the expected length of its prediction error in the rows' units.
Eigen::VectorXd expected_errors(const Eigen::MatrixXd& rows, Eigen::Index rows_per_pose, const Eigen::MatrixXd& factor);

/// Chooses `count` different candidates beside `given` ones, which stay: greedily, then by exchanging one at a time
/// for the best other until no exchange helps (Fedorov 1972; Cook & Nachtsheim 1980). Deterministic.
/// Precondition: count + given.size() <= candidates. `step`, if given, is called after each search for a best candidate.
std::vector<std::size_t> exchange(const Experiment& experiment, Criterion criterion, std::size_t count,
                                  const std::vector<std::size_t>& given = {}, const std::function<void()>& step = {});

}  // namespace mdhcal::offline
