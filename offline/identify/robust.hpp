// SPDX-License-Identifier: MIT
// Weights that take gross errors out of a fit, from each row's standardised error norm.
#pragma once

#include <cstddef>
#include <vector>

namespace mdhcal::offline {

enum class Loss { squares, huber, tukey };

/// Tuning constants in units of the scale of one axis's residual. Huber: 1.345. Tukey: 4.5, where the weight reaches 0.
/// Beyond 3.0, for three axes 4.6 standard deviations of one axis, a row is named an outlier and judges nothing.
/// (docs/method.md says on which data they were chosen.)
inline constexpr double huber_threshold = 1.345;
inline constexpr double tukey_threshold = 4.5;
inline constexpr double outlier_threshold = 3.0;
/// Tukey's weight at the outlier threshold: a row with less is an outlier.
inline constexpr double outlier_weight = (1.0 - 4.0 / 9.0) * (1.0 - 4.0 / 9.0);

/// Scale of one axis's residual: the median of the standardised error norms times `factor` (what the fit's degrees of
/// freedom took), never below `floor`: with few poses and many parameters a bare median collapses and good poses are
/// named.
double robust_scale(const std::vector<double>& error_norms, double factor, double floor);

/// Weight of a row in the reweighted squares (Huber 1964; Beaton and Tukey 1974).
double robust_weight(Loss loss, double error_norm, double scale);

/// robust_weight() of every row; empty for squares.
std::vector<double> robust_weights(Loss loss, const std::vector<double>& error_norms, double scale);

}  // namespace mdhcal::offline
