// SPDX-License-Identifier: MIT
// What each choice of families reaches on rows that took no part, beside what cross-validation says of it:
//   bench_families ROBOT MEASUREMENTS POSES DRAWS      poses drawn at random, the others held out
//   bench_families ROBOT MEASUREMENTS groups           each group held out in turn
//   bench_families ROBOT MEASUREMENTS FIRST STEP       rows FIRST, FIRST + STEP, ... to train (STEP negative: of the poses drawn)
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <numeric>

#include "offline/base/random.hpp"
#include "offline/base/statistics.hpp"
#include "offline/identify/calibrate.hpp"
#include "offline/identify/families/family_choice.hpp"
#include "offline/robot/vectors.hpp"

namespace {

using namespace mdhcal::offline;

double seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

struct Outcome {
  std::vector<std::string> names;
  std::vector<double> error_mm;            // cross-validated
  std::vector<std::vector<double>> held_out;
  std::size_t chosen = 0;
  double time_geometry = 0, time_families = 0;
};

Outcome run(const Robot& robot, const Dataset& data, const std::vector<std::size_t>& training, const std::vector<std::size_t>& testing) {
  Dataset train = data;
  train.rows.clear();
  train.commanded.clear();
  train.temperature.clear();
  train.direction.clear();
  std::map<std::uint32_t, std::uint32_t> groups;
  for (const std::size_t row : training) {
    train.rows.push_back(data.rows[row]);
    const auto group = groups.emplace(data.rows[row].group, static_cast<std::uint32_t>(groups.size())).first->second;
    train.rows.back().group = group;
  }
  std::vector<std::string> names(groups.size());
  for (const auto& [from, to] : groups) names[to] = data.groups[from];
  train.groups = names;
  CalibrationOptions options;
  options.cross_validate = false;
  options.joints = JointReadings::read;
  Outcome out;
  double t = seconds();
  const Calibration c = calibrate(robot, train, options);
  out.time_geometry = seconds() - t;
  t = seconds();
  Layout layout = c.layout;
  Estimate at = c.estimate;
  at.transmission.gravity.direction[2] = -1.0;
  for (std::int32_t i = 0; i < robot.geometry.joint_count; ++i) {
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (const Measurement& m : train.rows) low = std::min(low, m.q[static_cast<std::size_t>(i)]), high = std::max(high, m.q[static_cast<std::size_t>(i)]);
    at.transmission.function[i].seen_min_rad = low;
    at.transmission.function[i].seen_max_rad = high;
    for (std::int32_t j = i; j < robot.geometry.joint_count; ++j) layout.terms.push_back({TermFamily::gravity, i, j, false, 1e-3});
  }
  for (std::int32_t k = 1; k <= 40; ++k) {
    for (std::int32_t i = 0; i < robot.geometry.joint_count; ++i) {
      layout.terms.push_back({family_of_order(static_cast<std::size_t>(k)), i, k, false, 1e-3});
      layout.terms.push_back({family_of_order(static_cast<std::size_t>(k)), i, k, true, 1e-3});
    }
  }
  Selection selection;
  selection.rows = c.training_rows;
  selection.robust_weight = c.robust_weight;
  const FamilyRows rows = family_rows(c.training, selection, layout, at, 0.02);
  FamilyFitControl control;
  const FamilyComparison comparison = compare_families(rows, candidates_for(rows.poses, true), control, 1);
  out.time_families = seconds() - t;
  out.chosen = comparison.chosen;
  for (const FamilyCandidate& candidate : comparison.candidates) {
    out.names.push_back(name(candidate.choice));
    out.error_mm.push_back(candidate.error_mm);
    const MeasurementModel model(moved(at, layout, candidate.fit.step.data()));
    out.held_out.emplace_back();
    for (const std::size_t row : testing) {
      double r[max_row_residuals];
      model.residual(data, row, r);
      out.held_out.back().push_back(std::sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]));
    }
    if (std::getenv("FAMILIES_VERBOSE") != nullptr) {
      std::printf("  %-40s", out.names.back().c_str());
      for (const double sd : candidate.fit.variances.sd) std::printf(" %.4f", sd);
      std::printf(" noise %.4f scale %.4f used %.1f settled %d logl %.1f folds:", candidate.fit.variances.noise, candidate.fit.scale, candidate.fit.parameters_used,
                  candidate.fit.settled, candidate.fit.log_likelihood);
      for (const FamilyFit& f : candidate.folds) std::printf(" %d", f.settled);
      std::printf("\n");
    }
  }
  return out;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) return 2;
  const Robot robot = read_robot(argv[1]);
  const Dataset data = read_dataset(argv[2], robot, "none");
  std::vector<std::pair<std::vector<std::size_t>, std::vector<std::size_t>>> splits;
  if (std::strcmp(argv[3], "groups") == 0) {
    for (std::uint32_t g = 0; g < data.groups.size(); ++g) {
      splits.emplace_back();
      for (std::size_t r = 0; r < data.rows.size(); ++r) (data.rows[r].group == g ? splits.back().second : splits.back().first).push_back(r);
    }
  } else if (argc > 4 && std::strcmp(argv[3], "every") == 0) {
    const auto first = static_cast<std::size_t>(std::atoi(argv[4]));
    const auto step = static_cast<std::size_t>(std::atoi(argv[5]));
    splits.emplace_back();
    for (std::size_t r = 0; r < data.rows.size(); ++r) (r >= first && (r - first) % step == 0 ? splits.back().first : splits.back().second).push_back(r);
  } else {
    const auto poses = static_cast<std::size_t>(std::atoi(argv[3]));
    const int draws = argc > 4 ? std::atoi(argv[4]) : 5;
    for (int draw = 0; draw < draws; ++draw) {
      std::vector<std::size_t> order(data.groups.size());
      std::iota(order.begin(), order.end(), 0U);
      Random random(static_cast<std::uint64_t>(draw) + 1);
      for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random.index(i)]);
      std::vector<bool> drawn(order.size(), false);
      for (std::size_t i = 0; i < poses; ++i) drawn[order[i]] = true;
      splits.emplace_back();
      for (std::size_t r = 0; r < data.rows.size(); ++r) (drawn[data.rows[r].group] ? splits.back().first : splits.back().second).push_back(r);
    }
  }
  std::map<std::string, std::vector<double>> pooled;
  std::vector<std::string> order;
  double chosen_mean = 0, chosen_p95 = 0, geometry_mean = 0;
  for (const auto& [train, test] : splits) {
    const Outcome o = run(robot, data, train, test);
    for (std::size_t k = 0; k < o.names.size(); ++k) {
      const Statistics s = statistics(o.held_out[k]);
      std::printf("%c %-40s cv %.4f  held out mean %.4f p95 %.4f max %.3f\n", k == o.chosen ? '*' : ' ', o.names[k].c_str(), o.error_mm[k], s.mean, s.p95, s.max);
      std::vector<double>& all = pooled[o.names[k]];
      if (all.empty()) order.push_back(o.names[k]);
      all.insert(all.end(), o.held_out[k].begin(), o.held_out[k].end());
    }
    const Statistics s = statistics(o.held_out[o.chosen]);
    std::vector<double>& all = pooled["chosen"];
    all.insert(all.end(), o.held_out[o.chosen].begin(), o.held_out[o.chosen].end());
    chosen_mean += s.mean / static_cast<double>(splits.size());
    chosen_p95 += s.p95 / static_cast<double>(splits.size());
    geometry_mean += statistics(o.held_out[0]).mean / static_cast<double>(splits.size());
    std::printf("geometry %.2f s, families %.2f s\n", o.time_geometry, o.time_families);
    std::fflush(stdout);
  }
  order.push_back("chosen");
  std::printf("pooled\n");
  for (const std::string& each : order) {
    const Statistics s = statistics(pooled[each]);
    std::printf("  %-40s mean %.4f p95 %.4f max %.3f\n", each.c_str(), s.mean, s.p95, s.max);
  }
  std::printf("chosen, mean of draws: mean %.4f p95 %.4f; geometry %.4f; ratio %.3f\n", chosen_mean, chosen_p95, geometry_mean, chosen_mean / geometry_mean);
  return 0;
}
