// SPDX-License-Identifier: MIT
#include "offline/base/statistics.hpp"

#include <algorithm>
#include <cmath>

namespace mdhcal::offline {

double percentile(const std::vector<double>& sorted, double share) {
  const double rank = share * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(rank);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (rank - static_cast<double>(below)) * (sorted[above] - sorted[below]);
}

Statistics statistics(std::vector<double> errors) {
  Statistics out;
  out.count = errors.size();
  if (errors.empty()) return out;
  std::sort(errors.begin(), errors.end());
  const auto n = static_cast<double>(errors.size());
  double squares = 0.0;
  for (double e : errors) {
    out.mean += e / n;
    squares += e * e;
  }
  // About the mean, in a second pass: the difference of two large sums would cancel.
  double scatter = 0.0;
  for (double e : errors) scatter += (e - out.mean) * (e - out.mean);
  out.max = errors.back();
  out.median = percentile(errors, 0.5);
  out.p95 = percentile(errors, 0.95);
  out.rms = std::sqrt(squares / n);
  out.sd = errors.size() > 1 ? std::sqrt(scatter / (n - 1.0)) : 0.0;
  return out;
}

}  // namespace mdhcal::offline
