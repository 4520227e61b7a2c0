// SPDX-License-Identifier: MIT
#include "offline/base/distributions.hpp"

#include <cmath>

namespace mdhcal::offline {

namespace {

// The continued fraction converges fast for x < (a + 1) / (a + b + 2); the caller sees to that.
double fraction(double x, double a, double b) {
  constexpr double tiny = 1e-300;
  const auto away = [](double v) { return std::abs(v) < tiny ? tiny : v; };
  double c = 1, d = 1 / away(1 - (a + b) * x / (a + 1)), value = d;
  for (int m = 1; m <= 10000; ++m) {
    const double even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
    d = 1 / away(1 + even * d);
    c = away(1 + even / c);
    value *= c * d;
    const double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
    d = 1 / away(1 + odd * d);
    c = away(1 + odd / c);
    value *= c * d;
    if (std::abs(c * d - 1) < 1e-15) break;
  }
  return value;
}

}  // namespace

double incomplete_beta(double x, double a, double b) {
  if (x <= 0) return 0;
  if (x >= 1) return 1;
  const double front =
      std::exp(std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) + a * std::log(x) + b * std::log1p(-x));
  if (x < (a + 1) / (a + b + 2)) return front * fraction(x, a, b) / a;
  return 1 - front * fraction(1 - x, b, a) / b;
}

double f_upper_tail(double f, double d1, double d2) {
  if (!(f > 0)) return 1;
  return incomplete_beta(d2 / (d2 + d1 * f), d2 / 2, d1 / 2);
}

double student_975(double freedom) {
  // P(|T| > t) = I_x(freedom / 2, 1 / 2) with x = freedom / (freedom + t^2) (DLMF 8.17); it falls with t. At one degree of
  // freedom t is 12.71.
  double low = 1.9;
  double high = 13.0;
  for (int i = 0; i < 60; ++i) {
    const double t = 0.5 * (low + high);
    (incomplete_beta(freedom / (freedom + t * t), 0.5 * freedom, 0.5) > 0.05 ? low : high) = t;
  }
  return 0.5 * (low + high);
}

}  // namespace mdhcal::offline
