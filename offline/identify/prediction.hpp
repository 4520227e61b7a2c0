// SPDX-License-Identifier: MIT
// What a fit predicts for one row, how far from the truth that may be, and what was measured.
#pragma once

#include "offline/identify/reduction.hpp"
#include "offline/identify/uncertainty.hpp"

namespace mdhcal::offline {

/// A fit as a predictor of rows.
struct Predictor {
  MeasurementModel model;
  const Layout& layout;
  const Covariance& covariance;
  double scale = 1;       ///< of one axis's residual in the fit, in the residual's scaled unit
  double noise_mm = 0.02;
  bool any_sigma = false;
};

struct Prediction {
  Vector3 error_mm{};     ///< predicted minus measured; a distance's in the first component
  Vector3 turn_mm{};      ///< of a full pose: the rotation vector of predicted * measured^-1, times the dataset's lever
  /// Norm of the residual over the covariance that is predicted for this very row (the parameters' at its joints, and the
  /// scale of the fit's residual on each axis), divided by the median that the norm of as many standard normal numbers
  /// has: 1 in half of the rows if the prediction is right.
  double standardised = 0;
  double mean_mm = 0;     ///< mean of the position error that the same covariance predicts
};

/// `row` is of a kind that measures something.
Prediction predict(const Predictor& predictor, const Dataset& data, std::size_t row);

}  // namespace mdhcal::offline
