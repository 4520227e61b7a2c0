// SPDX-License-Identifier: MIT
// Choosing the poses to measure, and what to expect of them, before the tracker is set up.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "offline/identify/unknowns.hpp"
#include "offline/plan/design.hpp"
#include "offline/plan/reach.hpp"

namespace mdhcal::offline {

struct PlanOptions {
  std::size_t count = 30;                ///< poses to choose
  Criterion criterion = Criterion::position;
  std::size_t candidate_count = 2000;    ///< drawn if no candidates are given
  std::uint64_t seed = 1;
  Reach reach;
  UnknownsOptions unknowns;                    ///< what will be fitted; unknowns.noise_mm is the tracker's
};

/// What is to be expected of one parameter.
struct ExpectedParameter {
  std::string name;
  bool is_angle = false;
  double prior_sd = 0;       ///< before measuring [rad] or [m]
  double expected_sd = 0;    ///< after [rad] or [m]
};

/// Expected length of the position error over the candidates [mm]: geometry, base and target, without the noise of a
/// single measurement.
struct ExpectedPosition {
  double rms_mm = 0, p95_mm = 0, max_mm = 0;
};

struct Plan {
  std::vector<Joints> poses;           ///< ordered so that each is near the one before
  std::vector<ExpectedParameter> parameters;
  ExpectedPosition expected;
  ExpectedPosition random_median;        ///< median over 50 random sets of as many of the candidates
  ExpectedPosition with_ten_more;        ///< if 10 further poses were chosen; equal to expected if there are none left
  std::size_t candidates = 0, unreachable = 0;
};

/// Chooses poses for a robot. `candidates` may be empty: then random reachable configurations are drawn. Those given are
/// kept only if reachable. The same arguments give the same plan.
/// `progress`, if given, is called with the steps done and an estimate of all.
/// Throws InputError if fewer candidates than poses are left, or if none in a hundred draws is reachable.
Plan make_plan(const Robot& robot, const PlanOptions& options, const std::vector<Joints>& candidates = {},
               const std::function<void(std::size_t, std::size_t)>& progress = {});

/// The experiment that measuring `candidates` on the nominal robot would be.
Experiment experiment_of(const Robot& robot, const UnknownsOptions& options, const std::vector<Joints>& candidates);

}  // namespace mdhcal::offline
