// SPDX-License-Identifier: MIT
// The report's figures, as gnuplot scripts.
#pragma once

#include <string>
#include <vector>

#include "offline/identify/calibration.hpp"
#include "offline/report/gnuplot.hpp"

namespace mdhcal::offline {

Figure distribution_figure(const Calibration& calibration);
Figure per_pose_figure(const Calibration& calibration);
Figure axes_figure(const Calibration& calibration);
Figure vectors_figure(const Calibration& calibration);
Figure lambda_figure(const LambdaReport& lambda);
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
