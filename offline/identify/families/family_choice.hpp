// SPDX-License-Identifier: MIT
// Which families enter: by cross-validation over whole poses inside the training rows.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "offline/identify/families/family_fit.hpp"

namespace mdhcal::offline {

struct FamilyCandidate {
  FamilyChoice choice;
  double error_mm = 0;             ///< mean over the poses of the mean error of their rows, each pose left out once
  FamilyFit fit;                   ///< on all rows
  std::vector<FamilyFit> folds;    ///< likewise without each fold
};

struct FamilyComparison {
  std::vector<FamilyCandidate> candidates;  ///< geometry first
  std::size_t chosen = 0;
};

/// The candidates that so many poses can carry: beside the geometry from 12 poses on (5 folds then leave two or three poses out),
/// all orders from 16; `functions`: whether a joint moved enough for one.
std::vector<FamilyChoice> candidates_for(std::size_t poses, bool functions);

/// The fold of each pose, drawn by `seed`; `folds` receives their number.
std::vector<std::uint32_t> family_folds(std::size_t poses, std::uint64_t seed, std::uint32_t& folds);

/// Fits every candidate on all rows and without each of five folds of poses, and chooses.
FamilyComparison compare_families(const FamilyRows& rows, const std::vector<FamilyChoice>& candidates, const FamilyFitControl& control,
                                  std::uint64_t seed);

}  // namespace mdhcal::offline
