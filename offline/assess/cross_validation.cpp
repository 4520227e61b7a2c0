// SPDX-License-Identifier: MIT
#include "offline/assess/cross_validation.hpp"

#include <algorithm>
#include <numeric>

#include "offline/base/random.hpp"
#include "offline/robot/vectors.hpp"

namespace mdhcal::offline {

RepeatedCrossValidation cross_validate(const Robot& robot, const Dataset& data, const CalibrationOptions& options,
                               std::size_t folds, const std::function<void(std::size_t, std::size_t)>& progress) {
  std::vector<std::size_t> order(data.groups.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  Random random(options.seed);
  for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random.index(i)]);
  RepeatedCrossValidation out;
  out.folds = folds == 0 ? order.size() : std::min(folds, order.size());
  std::vector<double> before;
  std::vector<double> after;
  for (std::size_t fold = 0; fold < out.folds; ++fold) {
    CalibrationOptions one = options;
    one.test_fraction = 0;
    one.cross_validate = false;
    for (std::size_t g = fold; g < order.size(); g += out.folds) {
      one.held_out_groups.push_back(static_cast<std::uint32_t>(order[g]));
    }
    const Calibration c = calibrate(robot, data, one);
    out.lambda.push_back(c.lambda.lambda);
    for (const RowResult& r : c.rows) {
      if (!r.test) continue;
      before.push_back(norm(r.before_mm));
      after.push_back(norm(r.after_mm));
    }
    if (progress) progress(fold + 1, out.folds);
  }
  out.before = statistics(before);
  out.after = statistics(after);
  return out;
}

}  // namespace mdhcal::offline
