// SPDX-License-Identifier: MIT
// Cross-validation inside the training set, by pose: repeats of one configuration and its reflectors never part.
#pragma once

#include <cstdint>
#include <vector>

#include "offline/identify/linearised.hpp"

namespace mdhcal::offline {

/// Which pose each row belongs to, numbered from 0 in the order of `rows`: rows of one group are one pose, and so are rows
/// with the same joint readings, bit by bit.
std::vector<std::uint32_t> poses_of(const Dataset& data, const std::vector<std::size_t>& rows);

struct Folds {
  std::vector<std::uint32_t> of_row;  ///< one a row given
  std::uint32_t count = 1;
};

/// Ten folds of whole poses, drawn by `seed`; one fold a pose (leave-one-out) below 20 poses.
Folds make_folds(const Dataset& data, const std::vector<std::size_t>& rows, std::uint64_t seed);

/// Judges a lambda by what was left out: for each fold, the others' triangles are solved with that lambda and the
/// full, not linearised, corrected model predicts the fold's rows.
class FoldJudge {
 public:
  /// `whole` is linearised at `at` with `selection`'s folds and weights. All must outlive the judge.
  FoldJudge(const Dataset& data, const Selection& selection, const Layout& layout, const Estimate& at,
            const Linearised& whole);

  /// Mean position error [mm] over the rows left out, gross errors (no robust weight) excepted.
  double error_mm(double lambda) const;

 private:
  const Dataset& data_;
  const Selection& selection_;
  const Layout& layout_;
  const Estimate& at_;
  const Linearised& whole_;
  std::vector<WithoutFold> rest_;
};

/// The error with the training rows themselves as the judge, as in the source.
double training_error_mm(const Dataset& data, const Selection& selection, const Layout& layout, const Estimate& at,
                         const Linearised& whole, double lambda);

}  // namespace mdhcal::offline
