// SPDX-License-Identifier: MIT
// How much a measured rotation weighs beside a measured position: their noise is not of one kind.
#pragma once

#include "offline/identify/reduction.hpp"

namespace mdhcal::offline {

/// The lever [mm] at which the rotations of full poses weigh as their scatter deserves: the ratio of the positions' to the
/// rotations' standard deviation about the fitted model. Variance components by residual squares over redundancy, the
/// redundancy being the rows' share of what the fit left free (Helmert 1907; Foerstner 1979), refitted until the ratio
/// rests. Returns data.rotation_lever_mm unchanged where no row of `selection` measures a rotation, all rows state
/// theirs, or either kind has fewer than six redundant numbers: a ratio of two scatters is then known to a factor of
/// two at best. `start` is near the solution.
double estimated_rotation_lever_mm(Dataset data, Selection selection, const Layout& layout, const Estimate& start,
                                   double noise_mm);

}  // namespace mdhcal::offline
