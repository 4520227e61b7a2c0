// SPDX-License-Identifier: MIT
#include "offline/identify/robust.hpp"

#include <algorithm>

namespace mdhcal::offline {

double robust_scale(const std::vector<double>& error_norms, double factor, double floor) {
  if (error_norms.empty()) return floor;
  std::vector<double> sorted = error_norms;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  return std::max(factor * *middle, floor);
}

double robust_weight(Loss loss, double error_norm, double scale) {
  const double e = error_norm / scale;
  switch (loss) {
    case Loss::huber: return e <= huber_threshold ? 1.0 : huber_threshold / e;
    case Loss::tukey: {
      const double u = e / tukey_threshold;
      return u < 1.0 ? (1.0 - u * u) * (1.0 - u * u) : 0.0;
    }
    case Loss::squares: break;
  }
  return 1.0;
}

std::vector<double> robust_weights(Loss loss, const std::vector<double>& error_norms, double scale) {
  if (loss == Loss::squares) return {};
  std::vector<double> weights;
  weights.reserve(error_norms.size());
  for (double e : error_norms) weights.push_back(robust_weight(loss, e, scale));
  return weights;
}

}  // namespace mdhcal::offline
