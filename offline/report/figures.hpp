// SPDX-License-Identifier: MIT
// The report's figures, as gnuplot scripts.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "offline/identify/calibrate.hpp"
#include "offline/identify/tikhonov.hpp"
#include "offline/report/gnuplot.hpp"

namespace mdhcal::offline {

/// What a rule would choose for lambda, and where that lies on the L-curve.
struct RuleChoice {
  std::string rule;
  double lambda = 0, residual_norm = 0, solution_norm = 0;
};

/// The regularized problem at the result, and what every rule says on it.
struct LambdaPicture {
  SpectralProblem problem;
  std::vector<RuleChoice> choices;    ///< the one that was made first
  std::vector<std::string> silent;    ///< rules without a choice here, and why
};

/// Empty if no parameter was estimated.
std::optional<LambdaPicture> lambda_picture(const Calibration& calibration);

/// Root mean square length of the position error [mm] that the covariance predicts at random readings within the joint
/// limits, with the target's position in the robot's base frame [mm].
struct PredictedAccuracy {
  std::vector<std::vector<double>> points;  ///< x, y, z, standard deviation
  double median_mm = 0, p95_mm = 0, max_mm = 0;
};
PredictedAccuracy predicted_accuracy(const Calibration& calibration);

Figure distribution_figure(const Calibration& calibration);
Figure per_pose_figure(const Calibration& calibration);
Figure axes_figure(const Calibration& calibration);
Figure vectors_figure(const Calibration& calibration);
Figure lambda_figure(const LambdaPicture& picture, const LambdaReport& chosen);
Figure spectrum_figure(const Calibration& calibration);
Figure accuracy_figure(const PredictedAccuracy& accuracy);

/// Error norm of a row [mm].
double before_norm_mm(const RowResult& row);
double after_norm_mm(const RowResult& row);

/// The measured row behind a result.
const Measurement& measurement(const Calibration& calibration, const RowResult& row);
/// `id`, or `id/target` with several targets.
std::string row_name(const Calibration& calibration, const RowResult& row);

}  // namespace mdhcal::offline
