// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

namespace mdhcal::offline {

/// Figures of a set of position error norms, in the unit of the errors.
struct Statistics {
  std::size_t count = 0;
  double max = 0;
  double mean = 0;    ///< the source's "MAE"
  double median = 0;  ///< of an even count, the mean of the two in the middle
  double sd = 0;      ///< with count - 1; 0 for one value
  double rms = 0;
  double p95 = 0;     ///< 95th percentile, linear interpolation between order statistics (rank 0.95 (count - 1))
};

/// Linear interpolation between the order statistics: rank share * (count - 1). `sorted` ascending, not empty.
double percentile(const std::vector<double>& sorted, double share);

/// All zero for an empty set. Values must be finite.
Statistics statistics(std::vector<double> errors);

}  // namespace mdhcal::offline
