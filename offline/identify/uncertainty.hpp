// SPDX-License-Identifier: MIT
// How far the result may be from the truth: noise, and the bias that regularization puts in.
#pragma once

#include <vector>

#include "offline/identify/model.hpp"

namespace mdhcal::offline {

/// Covariance of all unknowns of a layout, in the columns' units (mrad, mm, and the parameters' priors), row-major.
struct Covariance {
  std::size_t size = 0;
  std::vector<double> value;        ///< size x size
  std::size_t frame_size = 0;
  std::vector<double> frames;       ///< frame_size x frame_size: of base and targets if the geometry were known
  double sigma = 0;                 ///< estimated standard deviation of a scaled residual (mm without sigma)
  double prior_scale = 1;           ///< factor on the prior standard deviations that the deviations found suggest, >= 1
  double freedom = 0;               ///< degrees of freedom behind sigma
  double coverage_factor = 1.96;    ///< of a 95 % interval: Student's t with `freedom`

  double at(std::size_t i, std::size_t j) const { return value[i * size + j]; }
};

/// Standard deviation of the target position that `model` predicts at readings q, from the covariance: the root of the
/// trace of its 3x3 covariance [mm], and, if not null, the standard deviation along each tracker axis.
double predicted_position_sd_mm(const MeasurementModel& model, const Layout& layout, const Covariance& covariance,
                                const double* q, std::size_t target, double* axes_mm = nullptr);

}  // namespace mdhcal::offline
