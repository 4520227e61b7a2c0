// SPDX-License-Identifier: MIT
// Cross-validation of a whole fit: every training row predicted by a fit that has not seen its pose.
#pragma once

#include "offline/identify/fit.hpp"
#include "offline/identify/prediction.hpp"
#include "offline/identify/unknowns.hpp"

namespace mdhcal::offline {

struct LeftOut {
  std::size_t folds = 0;
  std::vector<Prediction> after;    ///< one a selected row
  std::vector<Vector3> before_mm;   ///< likewise: the nominal geometry, base and targets fitted without the row's pose
  std::vector<Vector3> before_turn_mm;  ///< and its Prediction::turn_mm
};

struct LeaveOutControl {
  bool robust = true;
  bool choose_lambda = true;  ///< by the default rule in each fold; else the fit's own
  double noise_mm = 0.02;
};

/// Each fold is left out in turn. The rest is solved on the problem that is linearised at `result`, and from there refined
/// with its own robust weights. `selection` has the folds and the weights of `result`; `start` is the nominal fit.
LeftOut leave_out(const Dataset& data, const Selection& selection, const Unknowns& unknowns, const Linearised& whole,
                  const Fit& result, const Estimate& start, const LeaveOutControl& control);

}  // namespace mdhcal::offline
