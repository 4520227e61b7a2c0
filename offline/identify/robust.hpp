// SPDX-License-Identifier: MIT
// Weights that take gross errors out of a fit, from each row's standardised error norm.
#pragma once

#include <cstddef>
#include <vector>

namespace mdhcal::offline {

enum class Loss { squares, huber, tukey };

/// Tuning constants in units of the scale of one axis's residual. Huber: 1.345. Tukey: 3.2, beyond which a row has no
/// weight and is named an outlier; for three axes that is 4.9 standard deviations of one axis.
inline constexpr double huber_threshold = 1.345;
inline constexpr double tukey_threshold = 3.2;

/// Scale of one axis's residual: the median of the standardised error norms, never below `floor`: with few poses and
/// many parameters a bare median collapses and good poses are named.
double robust_scale(const std::vector<double>& error_norms, double floor);

/// Weight of a row in the reweighted squares (Huber 1964; Beaton and Tukey 1974).
double robust_weight(Loss loss, double error_norm, double scale);

/// robust_weight() of every row; empty for squares.
std::vector<double> robust_weights(Loss loss, const std::vector<double>& error_norms, double scale);

}  // namespace mdhcal::offline
