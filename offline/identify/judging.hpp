// SPDX-License-Identifier: MIT
// The figures of a calibration: on its training rows, on rows held out, and on training rows left out of folds.
#pragma once

#include "offline/identify/left_out.hpp"
#include "offline/identify/calibration.hpp"

namespace mdhcal::offline {

/// Position error norm that is the outlier threshold for a scale of one axis's residual.
double outlier_error_norm(double scale);

/// 95 % bounds of the mean that errors like these have [unit of the errors]: `pose` says which of them belong together. Poses
/// are taken as drawn independently, rows of one pose as dependent in any way. The interval is Student's on the logarithm of
/// the mean, whose standard error is, to first order, that of the mean over the mean: errors are positive and skewed, their
/// spread goes with their size, and on the logarithm it does not. Not finite for fewer than two poses.
Bounds bounds_of_mean(const std::vector<double>& errors, const std::vector<std::uint32_t>& pose);

/// Figures of the rows that were fitted, appended to `out.rows`; those beyond the outlier threshold are named.
SplitFigures judge_training(const Fit& fit, Calibration& out);

/// Figures of rows that took no part, appended to `out.rows`. A row is named as gross if it is missed by more than the
/// outlier threshold times what the model predicts for that very row: the noise, the parameters' covariance at its joints,
/// and the model's own misfit (CrossValidation::misfit).
SplitFigures judge_held_out(const Predictor& predictor, const std::vector<std::size_t>& rows, Calibration& out);

/// Likewise of every training row by the fold that left it out; `calibration.rows` are those of judge_training(). Gross
/// measurements among them (named here and by the fit, at most a tenth, not lying together) count as the worst of the others:
/// held out, a row is a statement about the arm, here it is one that was found to be wrong.
CrossValidation judge_left_out(const LeftOut& left_out, const Calibration& calibration);

/// What the covariance predicts over the workspace: 600 random readings.
PredictedAccuracy predicted_accuracy(const MeasurementModel& model, const Layout& layout, const Covariance& covariance);

}  // namespace mdhcal::offline
