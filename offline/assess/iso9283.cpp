// SPDX-License-Identifier: MIT
#include "offline/assess/iso9283.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace mdhcal::offline {

namespace {

PoseTest test_of(const std::string& pose, const std::vector<Vector3>& errors) {
  PoseTest out;
  out.pose = pose;
  out.visits = errors.size();
  const auto n = static_cast<double>(errors.size());
  Vector3 mean{};
  for (const Vector3& e : errors) {
    for (std::size_t k = 0; k < 3; ++k) mean[k] += e[k] / n;
  }
  out.accuracy_mm = std::hypot(mean[0], mean[1], mean[2]);
  if (errors.size() < 2) return out;
  std::vector<double> distances;
  double mean_distance = 0;
  for (const Vector3& e : errors) {
    distances.push_back(std::hypot(e[0] - mean[0], e[1] - mean[1], e[2] - mean[2]));
    mean_distance += distances.back() / n;
  }
  double squares = 0;
  for (const double l : distances) squares += (l - mean_distance) * (l - mean_distance);
  out.repeatability_mm = mean_distance + 3 * std::sqrt(squares / (n - 1));
  return out;
}

}  // namespace

Iso9283 iso9283(const std::vector<Visit>& visits) {
  std::map<std::string, std::size_t> index;
  std::vector<std::pair<std::string, std::vector<Vector3>>> poses;
  for (const Visit& visit : visits) {
    const auto [at, is_new] = index.emplace(visit.pose, poses.size());
    if (is_new) poses.emplace_back(visit.pose, std::vector<Vector3>{});
    poses[at->second].second.push_back(visit.error_mm);
  }
  Iso9283 out;
  for (const auto& [pose, errors] : poses) {
    const PoseTest& test = out.poses.emplace_back(test_of(pose, errors));
    out.largest_accuracy_mm = std::max(out.largest_accuracy_mm, test.accuracy_mm);
    if (test.visits < 2) continue;
    out.fewest_visits = out.repeated == 0 ? test.visits : std::min(out.fewest_visits, test.visits);
    ++out.repeated;
    out.largest_repeatability_mm = std::max(out.largest_repeatability_mm, test.repeatability_mm);
  }
  return out;
}

}  // namespace mdhcal::offline
