// SPDX-License-Identifier: MIT
// From the fit of the geometry to the model that is used: families chosen, identified together, predicted without each fold.
#pragma once

#include "offline/identify/calibration.hpp"
#include "offline/identify/families/family_fit.hpp"
#include "offline/identify/left_out.hpp"

namespace mdhcal::offline {

struct FamilyModelOptions {
  std::string model = "auto";   ///< --model: auto, geometry, gravity, joints, full
  double noise_mm = 0.02;
  bool robust = true;
  bool leave_out = true;
  std::uint64_t seed = 1;
};

/// What comes of it. Where the geometry alone is chosen only `report` is filled in: the geometry's own fit stands.
struct FamilyModel {
  bool beyond_geometry = false;
  ModelReport report;
  Layout layout;                       ///< base, targets, geometry and the terms of the families chosen
  Fit fit;
  std::vector<double> robust_weight;   ///< one a selected row
  double lambda = 0;                   ///< the noise's variance over the geometry's
  double parameters_used = 0;          ///< degrees of freedom that the fit took
  Covariance covariance;               ///< joint posterior of all columns of the layout
  std::optional<LeftOut> left_out;     ///< every selected row by the fold that did not see its pose
};

/// Compares the families on poses of `selection` (its weights are those of `geometry`), and identifies those that are chosen, or
/// asked for, together with base, targets and geometry. `start` is the nominal fit. Throws InputError where --model asks for what
/// the measurements cannot tell.
FamilyModel identify_families(const Robot& robot, const Dataset& data, const Selection& selection, const Unknowns& unknowns,
                              const Fit& geometry, const Estimate& start, const FamilyModelOptions& options);

}  // namespace mdhcal::offline
