// SPDX-License-Identifier: MIT
#pragma once

namespace mdhcal::offline {

/// Regularized incomplete beta function I_x(a, b), x in [0, 1], a and b > 0, by its continued fraction (Lentz's
/// evaluation; DLMF 8.17.22). Absolute error below 1e-12 for a, b up to 1e5.
double incomplete_beta(double x, double a, double b);

/// P(F >= f) for Fisher's F with d1 and d2 degrees of freedom; 1 for f <= 0.
double f_upper_tail(double f, double d1, double d2);

/// The t that Student's distribution with `freedom` >= 1 degrees of freedom exceeds in absolute value in 5 of 100 cases.
double student_975(double freedom);

}  // namespace mdhcal::offline
