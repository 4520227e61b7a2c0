// SPDX-License-Identifier: MIT
// Times that docs/performance.md records.
#include <benchmark/benchmark.h>

#include "offline/assess/bootstrap.hpp"
#include "offline/identify/calibrate.hpp"
#include "offline/simulate/family.hpp"
#include "offline/simulate/simulate.hpp"

namespace {

using namespace mdhcal::offline;

Simulation simulated(std::size_t poses) {
  SimulationOptions options;
  options.configurations = poses;
  options.test_configurations = 1;
  options.outlier_fraction = 0.02;
  return simulate(family_robot("three-parallel"), options);
}

// A whole calibration: starting values, gross errors, choice of lambda, spectrum and covariance.
void calibration(benchmark::State& state) {
  const Simulation s = simulated(static_cast<std::size_t>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(calibrate(s.nominal, s.train, {}).estimate);
  state.counters["ns_per_pose"] = benchmark::Counter(static_cast<double>(state.range(0)) * 1e-9,
                                                     benchmark::Counter::kIsIterationInvariantRate |
                                                         benchmark::Counter::kInvert);
}
BENCHMARK(calibration)->Arg(100)->Arg(1000)->Arg(10000)->Arg(100000)->Arg(1000000)->Unit(benchmark::kMillisecond);

void calibration_by_folds(benchmark::State& state) {
  const Simulation s = simulated(1000);
  CalibrationOptions options;
  options.lambda_rule = "rpim";
  for (auto _ : state) benchmark::DoNotOptimize(calibrate(s.nominal, s.train, options).estimate);
}
BENCHMARK(calibration_by_folds)->Unit(benchmark::kMillisecond);

void bootstrap_of_1000(benchmark::State& state) {
  const Simulation s = simulated(1000);
  const Calibration c = calibrate(s.nominal, s.train, {});
  for (auto _ : state) {
    benchmark::DoNotOptimize(bootstrap(c, 1000, 1, static_cast<unsigned int>(state.range(0))).low.data());
  }
}
BENCHMARK(bootstrap_of_1000)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace

BENCHMARK_MAIN();
