// SPDX-License-Identifier: MIT
// Cross-validation inside the training set, by group: repeats of one configuration never part.
#pragma once

#include <cstdint>
#include <vector>

#include "offline/identify/reduction.hpp"
#include "offline/identify/tikhonov.hpp"

namespace mdhcal::offline {

struct Folds {
  std::vector<std::uint32_t> of_row;  ///< one a row given
  std::uint32_t count = 1;
};

/// Ten folds of whole groups, drawn by `seed`; one fold a group (leave-one-out) below 20 groups.
Folds make_folds(const Dataset& data, const std::vector<std::size_t>& rows, std::uint64_t seed);

/// Judges a lambda by what was left out: for each fold, the others' triangles are solved with that lambda and the
/// full, not linearised, corrected model predicts the fold's rows.
class FoldJudge {
 public:
  /// `parts` are the folds' triangles at `model` with `selection`'s weights.
  FoldJudge(const Dataset& data, const Selection& selection, const Layout& layout, const MeasurementModel& model,
            const std::vector<Triangle>& parts);

  /// Mean position error [mm] over the rows left out, gross errors (no robust weight) excepted.
  double error_mm(double lambda) const;

 private:
  struct Part {
    ReducedSystem system;
    SpectralProblem problem;
  };
  const Dataset& data_;
  const Selection& selection_;
  const Layout& layout_;
  const MeasurementModel& model_;
  Eigen::VectorXd x0_;
  std::vector<Part> part_;
};

/// How much of the rows counts as independent, in (0, 1]: repeats of one configuration (rows of one group and target)
/// share the errors that the model does not hold, so n repeats inform like n / (1 + (n - 1) r), r being the correlation
/// of their residuals. 1 without repeats. (the design effect, Kish 1965)
double independent_share(const Dataset& data, const Selection& selection, const MeasurementModel& model);

/// The same with the training rows themselves as the judge, as in the source.
double training_error_mm(const Dataset& data, const Selection& selection, const Layout& layout, const MeasurementModel& model,
                         const ReducedSystem& system, const SpectralProblem& problem, double lambda);

}  // namespace mdhcal::offline
