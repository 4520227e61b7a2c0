// SPDX-License-Identifier: MIT
// How well a job fits with its whole geometry, on few rows and with a fixed lambda: what the best of the screening are
// compared by, before a calibration is run.
#pragma once

#include "offline/identify/fit.hpp"
#include "offline/identify/mistakes/job.hpp"

namespace mdhcal::offline {

/// At most this many rows judge; a longer file is thinned evenly.
inline constexpr std::size_t judging_rows = 150;

struct Judgement {
  /// Scale of one axis's residual [mm] with the geometry's deviations, in units of their priors, counted as residuals of
  /// one noise each: a cure that asks for a geometry a hundred priors away explains nothing. Infinite if no fit was made.
  double scale_mm = HUGE_VAL;
  double residual_mm = HUGE_VAL;  ///< the residual's part of it
  double spread_mm = HUGE_VAL;    ///< of an axis, the smaller of the measured points' and the predicted ones'
  double freedom = 0;             ///< scalar measurements less the unknowns that have no prior
  Fit fit;
  Layout layout;
  Selection selection;            ///< rows of the job's dataset, with robust weights
};

Judgement judge(const Job& job);

/// Median error norm, as that of one axis, of the positions in rows `begin` to `end` (excluded) of a dataset [mm].
double median_error_mm(const Estimate& estimate, const Dataset& data, std::size_t begin, std::size_t end);

/// Whether `b` explains more than `a` beyond what chance could make of it. They are scales of one axis read off some
/// `freedom_a` and `freedom_b` residuals; that the ratio of two such estimates of one and the same scale passes this bound in
/// any of `trials` has a probability below 1e-4 (F distribution, Bonferroni). The median of norms tells about half of what
/// the squares tell, so half the degrees of freedom are counted.
bool explains_more(double a_mm, double b_mm, double freedom_a, double freedom_b, std::size_t trials);

/// Evenly thinned rows of a job, whole file order kept.
Job thinned(const Job& job, std::size_t most);

}  // namespace mdhcal::offline
