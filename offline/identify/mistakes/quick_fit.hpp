// SPDX-License-Identifier: MIT
// How well positions fit the nominal arm, base and targets free, in some hundred microseconds: what thousands of
// hypotheses are screened by.
#pragma once

#include <cmath>
#include <vector>

#include "offline/identify/model.hpp"

namespace mdhcal::offline {

/// A measured position and the readings that belong to it.
struct Sighting {
  Joints q{};
  Vector3 measured_m{};
  std::uint32_t target = 0;
};

/// The rows of `data` that state a position.
std::vector<Sighting> sightings_of(const Dataset& data);

/// How far points lie from their mean along one axis: root of the mean square [m]. NaN of none.
double spread_of(const std::vector<Vector3>& points);

struct QuickFit {
  /// Scale of one axis's residual over the smaller of two spreads, that of the measured and that of the predicted
  /// points: 1 says that nothing is explained, and shrinking one side never makes it less. Infinite where the geometry or
  /// a reading is out of range, or where there are fewer measurements than unknowns.
  double misfit = HUGE_VAL;
  double scale_m = HUGE_VAL;      ///< of one axis's residual: from the median of the error norms
  double affine_misfit = HUGE_VAL;///< the same of the best affine map (12 unknowns and the targets), from the squares
  double length_ratio = 1;        ///< measured lengths over predicted ones, of the affine map
  bool mirrored = false;          ///< the affine map turns a right hand into a left one
  Estimate estimate;              ///< nominal geometry, base and targets as fitted
};

/// Fits base and `targets` target points to the sightings: the linear start of METHOD.md section 3, then Gauss-Newton
/// with Huber weights. `nominal` states the geometry, and the target points where the linear start has too few rows.
QuickFit quick_fit(const Estimate& nominal, const std::vector<Sighting>& sightings);

}  // namespace mdhcal::offline
