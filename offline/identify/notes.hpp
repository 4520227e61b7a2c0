// SPDX-License-Identifier: MIT
// What a calibration says about its rows and about itself.
#pragma once

#include "offline/identify/calibrate.hpp"

namespace mdhcal::offline {

/// What judges a row: nominal and corrected estimate, and the training residual's scale.
struct RowJudge {
  Estimate before, after;
  double noise_mm;
  bool any_sigma;
  double scale;
};

/// Position error norm that is the outlier threshold for a scale of one axis's residual.
double outlier_error_norm(double scale);

/// Residuals of the rows before and after, appended to `results`, and their figures.
SplitFigures judge_rows(const RowJudge& judge, const Dataset& data, const std::vector<std::size_t>& rows, bool test,
                        std::vector<RowResult>& results);

/// Notes on rank, on weak and lost parameters, on few measurements and on what is in no parameter.
void add_standing_notes(const Dataset& data, Calibration& calibration);

/// One sentence: what the calibration did, on which rows that was judged, or that it is untested.
std::string verdict_of(const Calibration& calibration);

}  // namespace mdhcal::offline
