// SPDX-License-Identifier: MIT
// Private to lib/src. Where a joint function holds: its window, in sectors of a turn.
#pragma once

#include "mdhcal/transmission.hpp"

namespace mdhcal {
namespace {

constexpr double sectors_per_rad = 10.185916357881302;  // 64 / (2 pi)
/// A window that falls within one sector bends by more than the sector's polynomial follows.
constexpr std::int32_t least_fade = 2;

/// The readings seen, in whole sectors.
struct Window {
  std::int32_t first;    ///< sector in which they begin, any turn
  std::int32_t sectors;  ///< how many; turn_sectors: all
  std::int32_t fade;     ///< over how many sectors the window falls on either side; 0: it does not
};

/// The largest integer that is not above x; |x| is below 2^30.
inline std::int32_t floor_of(double x) {
  const auto whole = static_cast<std::int32_t>(x);
  return static_cast<double>(whole) > x ? whole - 1 : whole;
}

/// Of a function whose readings seen are finite and within max_reading. An end that is off a sector's by a rounding is on it.
inline Window window_of(const JointFunction& f) {
  constexpr double rounding = 1e-9;  // of a sector: at max_reading 1e4 sectors, rounded to 2e-12 of one
  const std::int32_t first = -floor_of(rounding - f.seen_min_rad * sectors_per_rad);
  const std::int32_t sectors = floor_of(f.seen_max_rad * sectors_per_rad + rounding) - first;
  const std::int32_t gap = turn_sectors - sectors;
  if (gap < 2 * least_fade) return {first, turn_sectors, 0};
  return {first, sectors, gap / 2 < fade_sectors ? gap / 2 : fade_sectors};
}

/// The window's value, and its derivative by the reading in `slope` [1/rad].
inline double window_at(const Window& window, double reading_rad, double& slope) {
  slope = 0.0;
  if (window.fade == 0) return 1.0;
  double x = reading_rad * sectors_per_rad - static_cast<double>(window.first);
  x -= static_cast<double>(turn_sectors) * static_cast<double>(floor_of(x / static_cast<double>(turn_sectors)));
  const double after = x - static_cast<double>(window.sectors);
  const double before = static_cast<double>(turn_sectors) - x;
  if (after <= 0.0) return 1.0;
  const double fade = static_cast<double>(window.fade);
  const double s = (after < before ? after : before) / fade;
  if (s >= 1.0) return 0.0;
  const double steep = -6.0 * s * (1.0 - s) * sectors_per_rad / fade;
  slope = after < before ? steep : -steep;
  return 1.0 - s * s * (3.0 - 2.0 * s);
}

}  // namespace
}  // namespace mdhcal
