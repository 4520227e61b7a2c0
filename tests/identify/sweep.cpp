// SPDX-License-Identifier: MIT
// The long sweeps behind docs/method.md: identify_sweep arms|gross|coverage|shared|methods|moves|thresholds [COUNT] [RULE]
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>

#include "offline/base/error.hpp"
#include "offline/base/random.hpp"
#include "offline/identify/mistakes/diagnose.hpp"
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

// The 95 % intervals of the parameters; `shared`: of 40 poses with three reflectors each and an error of 0.1 mm an axis that they share.
void cover(std::uint64_t count, bool shared, const std::string& rule) {
  for (const std::string& family : family_names()) {
    std::size_t inside = 0, all = 0;
    std::vector<std::pair<int, int>> each;
    std::vector<std::string> names;
    for (std::uint64_t seed = 1; seed <= count; ++seed) {
      SimulationOptions so = arm_options(seed);
      so.angle_error_rad = 1e-3;  // the prior's
      if (shared) so.targets = 3, so.configurations = 40;
      Simulation s = simulate(family_robot(family), so);
      if (shared) add_shared_error(s.train, 0.1e-3, seed);
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

// A tracker that moved before row 31 of 60: how often it is named, by the size of the move; 0 is a false alarm.
void moves(std::uint64_t count) {
  struct Setting {
    const char* what;
    double noise_mm;
    bool stated;
  };
  for (const Setting& setting : {Setting{"noise 0.02 mm", 0.02, false}, Setting{"noise 0.1 mm, not stated", 0.1, false},
                                 Setting{"noise 0.1 mm, in sigma", 0.1, true}}) {
    for (const double shift_mm : {0.0, 0.05, 0.1, 0.15, 0.2, 0.3, 0.5, 1.0, 2.0}) {
      std::size_t named = 0, refused = 0, all = 0;
      double worst = 0;
      for (const std::string& family : family_names()) {
        for (std::uint64_t seed = 1; seed <= count; ++seed) {
          SimulationOptions so = arm_options(seed);
          so.noise_m = 1e-3 * setting.noise_mm;
          so.state_sigma = setting.stated;
          Simulation s = simulate(family_robot(family), so);
          Random random(seed);
          Vector3 shift{random.normal(), random.normal(), random.normal()};
          const double length = std::sqrt(shift[0] * shift[0] + shift[1] * shift[1] + shift[2] * shift[2]);
          for (std::size_t i = 30; i < s.train.rows.size(); ++i) {
            for (std::size_t k = 0; k < 3; ++k) s.train.rows[i].position_m[k] += 1e-3 * shift_mm * shift[k] / length;
          }
          ++all;
          try {
            Calibration c = calibrate(s.nominal, s.train, {});
            (void)explain_by_mistakes({s.nominal, s.train, {}}, false, c);
            if (c.usable()) worst = std::max(worst, distance_from_truth_mm(s, c, 200, seed));
            else (c.reasons.front().find("moved before row") != std::string::npos ? named : refused) += 1;
          } catch (const std::runtime_error&) {
            ++refused;
          }
        }
      }
      std::printf("%-26s move %.2f mm: named %zu of %zu, refused otherwise %zu; worst mean error of the rest %.3f mm\n",
                  setting.what, shift_mm, named, all, refused, worst);
    }
  }
}

// Two kinds of arm that no threshold was chosen on: one that slides, and one with an elbow off to the side.
Robot other_robot(const std::string& kind) {
  struct Row {
    double alpha_deg, a_mm, d_mm, min, max;
    bool slides;
  };
  std::vector<Row> rows;
  if (kind == "scara") {
    rows = {{0, 0, 300, -170, 170, false}, {0, 325, 0, -145, 145, false}, {180, 275, 0, 0, 200, true},
            {0, 0, 0, -170, 170, false}};
  } else if (kind == "offset elbow") {
    rows = {{0, 0, 660, -160, 160, false},   {-90, 0, 0, -110, 110, false},  {0, 432, 149, -135, 135, false},
            {-90, -20, 433, -110, 170, false}, {90, 0, 0, -100, 100, false}, {-90, 0, 56, -170, 170, false}};
  } else {
    return family_robot(kind);
  }
  std::string text = "name = \"" + kind + "\"\n";
  for (const Row& row : rows) {
    text += "[[link]]\nalpha = " + std::to_string(row.alpha_deg) + "\na = " + std::to_string(row.a_mm) +
            "\nd = " + std::to_string(row.d_mm) + "\ntheta = 0\nmin = " + std::to_string(row.min) +
            "\nmax = " + std::to_string(row.max) + (row.slides ? "\njoint = \"prismatic\"\n" : "\n");
  }
  return parse_robot(text + "[tool]\nxyz = [60, 40, 80]\n", kind);
}

// The outlier rules on seeds, arms and conditions that no threshold was chosen on.
void thresholds(std::uint64_t count) {
  struct Setting {
    const char* what;
    std::size_t poses;
    double noise_mm, gross_share, gross_mm;
  };
  const Setting settings[] = {{"30 poses", 30, 0.02, 0.05, 0},          {"100 poses", 100, 0.02, 0.05, 0},
                              {"noise 0.1 mm, not stated", 60, 0.1, 0.05, 0}, {"10 % gross", 60, 0.02, 0.1, 0},
                              {"20 % gross", 60, 0.02, 0.2, 0},         {"gross of 0.15 mm", 60, 0.02, 0.05, 0.15},
                              {"gross of 0.3 mm", 60, 0.02, 0.05, 0.3}};
  for (const Setting& setting : settings) {
    std::size_t named_gross = 0, all_gross = 0, named_good = 0, all_good = 0, refused = 0;
    double clean = 0, gross = 0;
    for (const std::string family : {"three-parallel", "spherical-wrist", "seven-joint", "five-joint", "scara",
                                     "offset elbow"}) {
      for (std::uint64_t seed = 20001; seed < 20001 + count; ++seed) {
        SimulationOptions so = arm_options(seed);
        so.configurations = setting.poses;
        so.noise_m = 1e-3 * setting.noise_mm;
        Simulation s = simulate(other_robot(family), so);
        const double without = distance_from_truth_mm(s, calibrate(s.nominal, s.train, {}), 300, seed);
        std::vector<std::size_t> bad;
        const Dataset before = s.train;
        bad = add_gross_errors(s.train, setting.gross_share, seed);
        for (const std::size_t row : bad) {
          if (!(setting.gross_mm > 0)) break;
          Vector3& p = s.train.rows[row].position_m;
          const Vector3& q = before.rows[row].position_m;
          const double length = std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]);
          for (std::size_t k = 0; k < 3; ++k) p[k] = q[k] + 1e-3 * setting.gross_mm * (p[k] - q[k]) / length;
        }
        try {
          const Calibration c = calibrate(s.nominal, s.train, {});
          clean += without;
          gross += distance_from_truth_mm(s, c, 300, seed);
          for (const RowResult& r : c.rows) {
            const bool is_bad = std::binary_search(bad.begin(), bad.end(), r.row);
            (is_bad ? all_gross : all_good) += 1;
            if (r.outlier) (is_bad ? named_gross : named_good) += 1;
          }
        } catch (const std::runtime_error&) {
          ++refused;
        }
      }
    }
    std::printf("%-26s gross named %zu of %zu, good named %zu of %zu, error with / without gross %.3f, refused %zu\n",
                setting.what, named_gross, all_gross, named_good, all_good, gross / clean, refused);
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
  else if (what == "coverage") cover(count, false, rule);
  else if (what == "shared") cover(count, true, rule);
  else if (what == "methods") methods(count);
  else if (what == "moves") moves(count);
  else if (what == "thresholds") thresholds(count);
  else std::fprintf(stderr, "usage: identify_sweep arms|gross|coverage|shared|methods|moves|thresholds [COUNT] [RULE]\n");
  return 0;
}
