// SPDX-License-Identifier: MIT
#include "offline/identify/verdict.hpp"

#include <algorithm>
#include <cmath>

#include "offline/base/sentences.hpp"
#include "offline/identify/named_rows.hpp"

namespace mdhcal::offline {

namespace {

std::string counted(std::size_t count, const char* word) {
  return std::to_string(count) + " " + word + (count == 1 ? "" : "s");
}

std::string first_of(const std::vector<std::string>& names) {
  constexpr std::size_t most = 8;
  if (names.size() <= most) return joined(names);
  std::vector<std::string> some(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(most - 1));
  some.push_back(std::to_string(names.size() - some.size()) + " more");
  return joined(some);
}

std::string judged_on(const Calibration& c) {
  const SplitFigures& figures = c.judged();
  const std::string rows = counted(figures.after.count, "row") + " of " + counted(figures.poses, "pose");
  if (c.test) return "Tested on " + rows + " held out";
  if (c.cross_validation) {
    return "Cross-validated (no rows were held out): " + rows + " in " + std::to_string(c.cross_validation->folds) +
           " folds of whole poses, each predicted by a fit that had not seen its pose";
  }
  return "On the " + rows + " that were fitted (they flatter: nothing was held out)";
}

std::string figures_text(const SplitFigures& figures) {
  std::string out = "mean error " + number(figures.after.mean) + " mm";
  if (std::isfinite(figures.mean.high)) {
    out += " (95 % bounds " + number(figures.mean.low) + " to " + number(figures.mean.high) + " mm)";
  }
  return out + ", maximum " + number(figures.after.max) + " mm; nominal " + number(figures.before.mean) + " mm, maximum " +
         number(figures.before.max) + " mm on the same rows.";
}

}  // namespace

std::string verdict_of(const Calibration& c) {
  const SplitFigures& figures = c.judged();
  std::string out;
  if (!c.usable()) {
    out = c.released() ? "Accepted against these reasons (\"" + c.accepted + "\"):" : std::string("Do not use this result:");
    for (const std::string& reason : c.reasons) out += " " + reason;
    out += "\n";
  }
  if (10 * figures.outliers.size() > figures.after.count) {
    out += counted(figures.outliers.size(), "row") + " of " + std::to_string(figures.after.count) +
           ", more than a tenth, lie beyond what the model predicts for them: measurements or model are wrong there. ";
  }
  out += judged_on(c) + ": " + figures_text(figures);
  const bool replaced = !c.test && figures.after_good.count > 0 && !figures.outliers.empty() &&
                        !(figures.after.max > figures.after_good.max);
  if (replaced) {
    out += " " + counted(figures.outliers.size(), "row") + " (" + first_of(figures.outliers) +
           ") measured grossly wrong count as the worst of the others.";
  } else if (!figures.outliers.empty()) {
    out += " Without " + counted(figures.outliers.size(), "gross row") + " (" + first_of(figures.outliers) + "): ";
    out += figures.after_good.count == 0
               ? "no row is left."
               : "mean error " + number(figures.after_good.mean) + " mm, maximum " + number(figures.after_good.max) +
                     " mm; nominal " + number(figures.before_good.mean) + " mm, maximum " + number(figures.before_good.max) +
                     " mm.";
  }
  if (figures.predicted_mean_mm > 0.0) out += " Predicted mean: " + number(figures.predicted_mean_mm) + " mm.";
  const std::string turned = rotation_sentence(c.judged_rotation(), c.test ? "held-out" : c.cross_validation ? "left-out" : "training");
  return turned.empty() ? out : out + " " + turned;
}

std::vector<std::string> findings_of(const Calibration& c) {
  std::vector<std::string> out;
  if (!c.train.outliers.empty()) {
    out.push_back("Outliers among the training rows (they have no weight in the fit, or little): " + first_of(c.train.outliers) +
                  ".");
  }
  for (const bool test : {false, true}) {
    const std::string shared = what_named_rows_share(c, test);
    if (!shared.empty()) out.push_back(shared);
  }
  if (c.cross_validation) {
    // The median of n norms of three axes has a standard error of 0.56 / sqrt(n) of itself (chi distribution).
    const CrossValidation& cv = *c.cross_validation;
    const double certain = 1.0 + 3.0 * 0.56 / std::sqrt(static_cast<double>(std::max<std::size_t>(1, cv.figures.poses)));
    if (cv.misfit > certain) {
      out.push_back("Rows left out of the fit are missed by " + number(cv.misfit) +
                    " times what noise and parameters' covariance predict: the model does not hold all that moves. The predicted "
                    "mean and the naming of gross rows reckon with it.");
    }
  }
  if (c.test && c.cross_validation) {
    const SplitFigures& t = *c.test;
    if (t.outliers.empty() && std::isfinite(t.mean.high) && t.predicted_mean_mm > 0.0 &&
        (t.predicted_mean_mm < t.mean.low || t.predicted_mean_mm > t.mean.high)) {
      out.push_back("The held-out rows are missed by " + number(t.after.mean) + " mm on average (95 % bounds " +
                    number(t.mean.low) + " to " + number(t.mean.high) + " mm) where the model predicts " +
                    number(t.predicted_mean_mm) + " mm: they lie in another part of the workspace, or were measured otherwise.");
    }
  }
  return out;
}

}  // namespace mdhcal::offline
