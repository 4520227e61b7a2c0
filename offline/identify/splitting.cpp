// SPDX-License-Identifier: MIT
#include "offline/identify/splitting.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "offline/base/error.hpp"
#include "offline/base/random.hpp"

namespace mdhcal::offline {

void split_off_test(const Dataset& data, const CalibrationOptions& options, std::vector<std::size_t>& training,
                    std::vector<std::size_t>& testing) {
  std::vector<std::uint32_t> order(data.groups.size());
  std::iota(order.begin(), order.end(), 0U);
  Random random(options.seed);
  for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random.index(i)]);
  const auto wanted = static_cast<std::size_t>(std::llround(options.test_fraction * static_cast<double>(order.size())));
  std::vector<bool> drawn(order.size(), false);
  for (std::size_t i = 0; i < std::min(wanted, order.size()); ++i) drawn[order[i]] = true;
  for (std::uint32_t group : options.held_out_groups) drawn[group] = true;
  for (std::size_t row = 0; row < data.rows.size(); ++row) {
    if (data.rows[row].kind == MeasurementKind::joints) continue;
    (drawn[data.rows[row].group] ? testing : training).push_back(row);
  }
}

Dataset aligned(const Dataset& test, const Dataset& training) {
  Dataset out = test;
  for (Measurement& m : out.rows) {
    const std::string& word = test.targets.empty() ? std::string() : test.targets[m.target];
    const auto found = std::find(training.targets.begin(), training.targets.end(), word);
    if (found == training.targets.end() && !(training.targets.empty() && word.empty())) {
      throw InputError(test.path, m.line, 0,
                       "Found the target \"" + word + "\", which the measurements to identify from do not have.");
    }
    m.target = static_cast<std::uint32_t>(found - training.targets.begin());
  }
  out.targets = training.targets;
  return out;
}

Dataset renamed(Dataset data, const std::vector<std::pair<std::string, std::string>>& twins) {
  for (const auto& [twin, target] : twins) {
    const auto from = std::find(data.targets.begin(), data.targets.end(), twin);
    const auto to = std::find(data.targets.begin(), data.targets.end(), target);
    if (from == data.targets.end()) continue;
    if (to == data.targets.end()) {
      *from = target;
      continue;
    }
    for (Measurement& m : data.rows) {
      if (m.target == static_cast<std::uint32_t>(from - data.targets.begin())) m.target = static_cast<std::uint32_t>(to - data.targets.begin());
    }
  }
  return data;
}

}  // namespace mdhcal::offline
