// SPDX-License-Identifier: MIT
// What planning is worth: planned poses against random ones, on simulated arms whose truth is known.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>

#include "offline/identify/fit.hpp"
#include "offline/plan/plan.hpp"
#include "offline/robot/rotation.hpp"
#include "offline/simulate/family.hpp"
#include "offline/simulate/simulate.hpp"

namespace {

using namespace mdhcal;
using namespace mdhcal::offline;

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return n % 2 == 1 ? values[n / 2] : 0.5 * (values[n / 2 - 1] + values[n / 2]);
}

constexpr double noise_mm = 0.02;

// A simulated arm that can be measured in configurations of one's choice, a thousand candidates and a test set.
class Bench {
 public:
  explicit Bench(const std::string& family, std::uint64_t seed) {
    SimulationOptions options;
    options.seed = seed;
    options.noise_m = noise_mm * 1e-3;
    options.configurations = 1000;
    simulation_ = simulate(family_robot(family), options);
    for (const Measurement& row : simulation_.train.rows) candidates.push_back(row.q);
  }

  const Robot& nominal() const { return simulation_.nominal; }

  /// Mean held-out position error [mm] after a calibration from those candidates: against noisy test measurements, and
  /// against the true positions.
  std::pair<double, double> held_out_mm(const std::vector<std::size_t>& chosen) const {
    const Setup setup = make_setup(simulation_.nominal, simulation_.train, chosen, {});
    Selection selection;
    selection.rows = chosen;
    const Fit frames = fit_frames(setup, simulation_.train, selection, noise_mm);
    FitControl control;
    control.lambda = noise_mm * noise_mm;  // maximum a posteriori for the simulated noise
    const Fit result = fit(simulation_.train, selection, setup.layout, frames.estimate, control);
    const Model model(result.estimate);
    Estimate true_estimate;
    true_estimate.geometry = simulation_.truth.geometry;
    true_estimate.tracker_T_base = frame_of(*simulation_.truth.tracker_T_base);
    true_estimate.flange_p_m = {simulation_.truth.targets[0].flange_p_m};
    const Model truth(true_estimate);
    double measured = 0, exact = 0;
    for (const Measurement& row : simulation_.test.rows) {
      const Vector3 predicted = model.target_position(row.q.data(), 0), real = truth.target_position(row.q.data(), 0);
      double m = 0, e = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        m += std::pow(predicted[k] - row.position_m[k], 2);
        e += std::pow(predicted[k] - real[k], 2);
      }
      measured += 1e3 * std::sqrt(m);
      exact += 1e3 * std::sqrt(e);
    }
    const auto count = static_cast<double>(simulation_.test.rows.size());
    return {measured / count, exact / count};
  }

  std::vector<Readings> candidates;

 private:
  Simulation simulation_;
};

struct Gain {
  double measured, exact;  // [1], against noisy test measurements and against the truth
};

// Median over the arms of the gain of N planned poses over the median of `sets` random sets of N.
Gain gain(std::size_t count, Criterion criterion, int arms, int sets) {
  const char* families[] = {"three-parallel", "spherical-wrist", "seven-joint", "five-joint"};
  std::vector<double> measured, exact;
  for (int arm = 0; arm < arms; ++arm) {
    const Bench bench(families[arm % 4], 100 + static_cast<std::uint64_t>(arm));
    const Experiment experiment = experiment_of(bench.nominal(), {}, bench.candidates);
    const auto planned = bench.held_out_mm(exchange(experiment, criterion, count));
    Random random(7);
    std::vector<double> random_measured, random_exact;
    for (int set = 0; set < sets; ++set) {
      std::vector<std::size_t> chosen;
      while (chosen.size() < count) {
        const std::size_t c = random.index(bench.candidates.size());
        if (std::find(chosen.begin(), chosen.end(), c) == chosen.end()) chosen.push_back(c);
      }
      const auto [m, e] = bench.held_out_mm(chosen);
      random_measured.push_back(m);
      random_exact.push_back(e);
    }
    measured.push_back(1 - planned.first / median(random_measured));
    exact.push_back(1 - planned.second / median(random_exact));
  }
  return {median(measured), median(exact)};
}

struct Case {
  std::size_t count;
  Criterion criterion;
  double least;
};

class PlanGain : public testing::TestWithParam<Case> {};

// Held-out error is the distance of the predicted from the true position: a measured one has the tracker's noise in it,
// which no choice of poses can lessen. Both figures are printed.
TEST_P(PlanGain, PlannedPosesBeatRandomOnes) {
  const Gain g = gain(GetParam().count, GetParam().criterion, 20, 200);
  std::printf("%zu poses: %.1f %% less error against the truth, %.1f %% against noisy test measurements\n",
              GetParam().count, 100 * g.exact, 100 * g.measured);
  EXPECT_GE(g.exact, GetParam().least);
}

INSTANTIATE_TEST_SUITE_P(Sets, PlanGain,
                         testing::Values(Case{20, Criterion::position, 0.15}, Case{50, Criterion::position, 0.06},
                                         Case{20, Criterion::d, 0.15}));

}  // namespace
