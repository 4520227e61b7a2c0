// SPDX-License-Identifier: MIT
// Measured rotations held against measured positions, before both enter one fit.
#pragma once

#include <string>
#include <vector>

#include "offline/identify/unknowns.hpp"

namespace mdhcal::offline {

/// How well rotations fit to a base frame that the positions alone gave, read in one convention.
struct RotationFit {
  RotationConvention convention;
  double factor = 1.0;       ///< of the angles as they were read: other than 1 for another unit
  double misfit_rad = 0;     ///< mean angle over the rows, the probes' turns fitted
};

/// Every convention that the columns could be meant in, best first, each with its inverse and, where the columns do not
/// state their unit, in degrees and in radians; of conventions that are the same one. `fitted` is an estimate from positions.
std::vector<RotationFit> rotation_fits(const Dataset& data, const std::vector<std::size_t>& rows, const Estimate& fitted);

/// The columns as they would have to be named or read, for a message: "qx, qy, qz, qw (--rotation quaternion-xyzw)".
std::string reading_of(const RotationFit& fit);

/// The rows that are full poses become positions.
void leave_out_rotations(Dataset& data);

/// Holds the rotations of the rows against a fit of their positions alone: why they must not enter the fit, a sentence, where
/// they are read in a convention in which they contradict the positions (the one that fits is named), where they fit in none,
/// or where a given turn of the probe is not that of the rotations. Empty where they agree, or where fewer than six rows are
/// full poses.
std::string why_rotations_contradict(const Robot& robot, const Dataset& data, const std::vector<std::size_t>& rows,
                                     const UnknownsOptions& options);

}  // namespace mdhcal::offline
