// SPDX-License-Identifier: MIT
// The long sweeps behind docs/method.md: identify_sweep arms|gross|coverage|methods|rules [COUNT]
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>

#include "offline/error.hpp"
#include "offline/simulate/family.hpp"
#include "tests/identify/simulated.hpp"

namespace {

using namespace mdhcal;
using namespace mdhcal::offline;
using namespace mdhcal::tests;

void arms(std::uint64_t count, bool gross, const std::string& rule) {
  std::printf("%-16s %s, rule %s\n", "family", gross ? "5 % gross errors" : "clean", rule.c_str());
  for (const std::string& family : family_names()) {
    double mean = 0, worst = 0;
    std::size_t wrong = 0, named_gross = 0, all_gross = 0, named_good = 0, all_good = 0, refused = 0;
    for (std::uint64_t seed = 1; seed <= count; ++seed) {
      Simulation s = simulate(family_robot(family), arm_options(seed));
      const std::vector<std::size_t> bad =
          gross ? add_gross_errors(s.train, 0.05, 1000 + seed) : std::vector<std::size_t>{};
      CalibrationOptions options;
      options.lambda_rule = rule;
      try {
        const Calibration c = calibrate(s.nominal, s.train, options);
        const double distance = distance_from_truth_mm(s, c, 1000, 5000 + seed);
        mean += distance / static_cast<double>(count);
        worst = std::max(worst, distance);
        wrong += distance > 0.025 ? 1 : 0;
        for (const RowResult& r : c.rows) {
          const bool is_bad = std::find(bad.begin(), bad.end(), r.row) != bad.end();
          (is_bad ? all_gross : all_good) += 1;
          if (r.outlier) (is_bad ? named_gross : named_good) += 1;
        }
      } catch (const std::runtime_error& e) {
        ++refused;
        std::printf("  seed %llu: %s\n", static_cast<unsigned long long>(seed), e.what());
      }
    }
    std::printf("%-16s mean %.5f mm, worst %.5f, above 0.025: %zu, refused %zu, gross named %zu/%zu, good named %zu/%zu\n",
                family.c_str(), mean, worst, wrong, refused, named_gross, all_gross, named_good, all_good);
  }
}

void cover(std::uint64_t count, const std::string& rule) {
  for (const std::string& family : family_names()) {
    std::size_t inside = 0, all = 0;
    std::vector<std::pair<int, int>> each;
    std::vector<std::string> names;
    for (std::uint64_t seed = 1; seed <= count; ++seed) {
      SimulationOptions so = arm_options(seed);
      so.angle_error_rad = 1e-3;  // the prior's
      const Simulation s = simulate(family_robot(family), so);
      CalibrationOptions options;
      options.lambda_rule = rule;
      const Calibration c = calibrate(s.nominal, s.train, options);
      const Coverage one = coverage(s, c);
      inside += one.inside;
      all += one.count;
      each.resize(one.inside_of.size());
      names.clear();
      for (std::size_t i = 0; i < one.inside_of.size(); ++i) {
        names.push_back(name(c.parameters[i].id));
        if (one.inside_of[i] >= 0) {
          each[i].first += one.inside_of[i];
          ++each[i].second;
        }
      }
    }
    std::printf("%-16s pooled %.2f %%;", family.c_str(), 100.0 * static_cast<double>(inside) / static_cast<double>(all));
    double low = 100, high = 0;
    for (std::size_t i = 0; i < each.size(); ++i) {
      if (each[i].second == 0) continue;
      const double share = 100.0 * each[i].first / each[i].second;
      if (share < 92 || share > 98) std::printf(" %s %.1f", names[i].c_str(), share);
      low = std::min(low, share);
      high = std::max(high, share);
    }
    std::printf(" each %.1f ... %.1f %%\n", low, high);
  }
}

void methods(std::uint64_t count) {
  for (const std::string& family : family_names()) {
    for (const char* method : {"nc", "lsm", "gd", "gn", "lm", "ekf", "rpim"}) {
      double mean = 0, worst = 0, iterations = 0;
      std::size_t converged = 0;
      for (std::uint64_t seed = 1; seed <= count; ++seed) {
        const Simulation s = simulate(family_robot(family), arm_options(seed));
        CalibrationOptions options;
        options.method = method;
        const Calibration c = calibrate(s.nominal, s.train, options);
        const double distance = distance_from_truth_mm(s, c, 1000, 5000 + seed);
        mean += distance / static_cast<double>(count);
        worst = std::max(worst, distance);
        iterations += c.iterations / static_cast<double>(count);
        converged += c.converged ? 1 : 0;
      }
      std::printf("%-16s %-5s mean %.5f worst %.5f mm, converged %zu/%llu, iterations %.1f\n", family.c_str(), method,
                  mean, worst, converged, static_cast<unsigned long long>(count), iterations);
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "";
  const std::uint64_t count = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 50;
  const std::string rule = argc > 3 ? argv[3] : "reml";
  if (what == "arms") arms(count, false, rule);
  else if (what == "gross") arms(count, true, rule);
  else if (what == "coverage") cover(count, rule);
  else if (what == "methods") methods(count);
  else std::fprintf(stderr, "usage: identify_sweep arms|gross|coverage|methods [COUNT] [RULE]\n");
  return 0;
}
