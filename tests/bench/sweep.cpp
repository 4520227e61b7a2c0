// SPDX-License-Identifier: MIT
// The long sweeps of the servo tick: `bench_sweep COUNT [SEED] [ROBOT.toml ...]` prints a line a workload. Thinned
// versions run in tests/lib.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "mdhcal/solutions.hpp"
#include "offline/robot/robot.hpp"
#include "tests/lib/tick_paths.hpp"

namespace {

using namespace mdhcal;
using namespace mdhcal::test;

constexpr double tolerance = 1e-6;

struct Counts {
  long ok = 0, other_branch = 0, false_claims = 0, over_limit = 0;
  int most = 0;
};

enum class Where { regular, wrist, elbow, singular };

double smallest(const Arm<double>& arm, const double* q) {
  double s[6];
  singular_values(arm, q, s);
  return s[0];
}

void one(const Arm<double>& arm, Where where, double limit, Random& random, Counts& counts) {
  double q[6];
  do {
    for (double& joint : q) joint = random.symmetric(pi);
    if (where == Where::wrist) q[4] = random.symmetric(0.01);
    if (where == Where::elbow) q[2] = random.symmetric(0.01);
    if (where == Where::singular) q[4] = 0;
  } while (where == Where::regular && smallest(arm, q) < 0.02);
  Pose<double> target{};
  if (forward(arm, q, target) != Status::ok) std::abort();
  double seed[6];
  for (int i = 0; i < 6; ++i) seed[i] = q[i] + (where == Where::singular && i == 4 ? 0 : random.symmetric(servo_step));
  TickOptions<double> options = default_tick_options(arm);
  options.goal.position_tolerance_m = options.goal.rotation_tolerance_rad = tolerance;
  if (limit > 0) std::fill(options.limits.max_step, options.limits.max_step + 6, limit);
  double result[6];
  std::copy(seed, seed + 6, result);
  TickReport<double> report{};
  const Status status = tick(arm, options, target, result, &report);
  counts.most = std::max<int>(counts.most, report.iterations);
  Pose<double> reached{};
  if (forward(arm, result, reached) != Status::ok) std::abort();
  const bool met = position_distance(reached, target) <= 1.001 * tolerance &&
                   small_angle(reached, target) <= 1.001 * tolerance;
  if (status == Status::ok) ++counts.ok;
  if ((status == Status::ok) != met) ++counts.false_claims;
  double away = 0;
  for (int i = 0; i < 6; ++i) {
    away = std::max(away, std::fabs(result[i] - q[i]));
    if (limit > 0 && std::fabs(result[i] - seed[i]) > limit) ++counts.over_limit;
  }
  if (met && away > 0.1) ++counts.other_branch;
}

void sweep(const std::string& name, const std::vector<Arm<double>>& arms, Where where, double limit, long count,
           std::uint64_t seed) {
  Random random(seed);
  Counts counts;
  for (long n = 0; n < count; ++n) one(arms[static_cast<std::size_t>(n) % arms.size()], where, limit, random, counts);
  std::printf("%-34s %ld poses: missed %ld, other branch %ld, false claims %ld, over the limit %ld; evaluations %d at most\n",
              name.c_str(), count, count - counts.ok, counts.other_branch, counts.false_claims, counts.over_limit,
              counts.most);
  std::fflush(stdout);
}

void all(const std::string& name, const std::vector<Arm<double>>& arms, long count, std::uint64_t seed) {
  sweep(name + ", wrist", arms, Where::wrist, 0, count, seed + 1);
  sweep(name + ", elbow", arms, Where::elbow, 0, count, seed + 2);
  sweep(name + ", wrist, step limit", arms, Where::wrist, servo_step, count, seed + 3);
  sweep(name + ", elbow, step limit", arms, Where::elbow, servo_step, count, seed + 4);
  sweep(name + ", regular", arms, Where::regular, 0, count, seed);
}

void arcs(const char* name, const Geometry& geometry, bool parallel, double errors_mm, int arms, std::uint64_t seed) {
  Random random(seed);
  Arm<double> nominal{};
  if (make_arm(geometry, nominal) != Status::ok) std::abort();
  Crossing worst;
  double ratio = 0;
  double path_ratio = 0;
  int over = 0;
  for (int n = 0; n < arms; ++n) {
    Arm<double> arm{};
    if (make_arm(with_errors(geometry, random, errors_mm * 1e-3, errors_mm * 0.1 * deg), arm) != Status::ok) std::abort();
    const Crossing found = cross_wrist(nominal, arm, arm, parallel, random);
    worst.position_m = std::max(worst.position_m, found.position_m);
    worst.rotation_rad = std::max(worst.rotation_rad, found.rotation_rad);
    worst.step = std::max(worst.step, found.step);
    ratio = std::max(ratio, found.rotation_rad / found.own_rad);
    path_ratio = std::max(path_ratio, found.rotation_rad / found.path_rad);
    if (found.rotation_rad > 2 * found.own_rad) ++over;
  }
  std::printf("arc, %s, %.1f mm, %d arms: position %.2f um, rotation %.2f mrad, over the arm's own error %.2f (more than "
              "2 on %d; over that on the path %.2f), step %.5f rad\n",
              name, errors_mm, arms, worst.position_m * 1e6, worst.rotation_rad * 1e3, ratio, over, path_ratio, worst.step);
  std::fflush(stdout);
}

double seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// The least of a few runs: what the tick takes when nothing else is in the way.
double duration(const Arm<double>& arm, const TickOptions<double>& options, const Due& due) {
  double least = 1;
  for (int run = 0; run < 5; ++run) {
    double q[6];
    std::copy(due.q, due.q + 6, q);
    const double before = seconds();
    if (tick(arm, options, due.target, q) == Status::bad_input) std::abort();
    least = std::min(least, seconds() - before);
  }
  return least;
}

// Regular ticks from seeds within a step.
double median_duration(const Arm<double>& arm, const TickOptions<double>& options, Random& random) {
  std::vector<double> durations;
  for (int k = 0; k < 400; ++k) {
    double joints[6];
    Due due;
    random_posture(arm, random, joints);
    for (int i = 0; i < 6; ++i) due.q[i] = joints[i] + random.symmetric(0.9 * servo_step);
    if (forward(arm, joints, due.target) != Status::ok) std::abort();
    durations.push_back(duration(arm, options, due));
  }
  std::nth_element(durations.begin(), durations.begin() + 200, durations.end());
  return durations[200];
}

void excursions(const char* name, const Geometry& geometry, double far_m, double limit, int arms, std::uint64_t seed) {
  Random random(seed);
  int unique = 0;
  int unique_lost = 0;
  int other_lost = 0;
  double away = 0;
  long unreachable = 0;
  long evaluations = 0;
  int most = 0;
  long wavering = 0;
  std::vector<double> costs;  // of every tick that does not meet its pose, over a regular one's
  for (int n = 0; n < arms; ++n) {
    Arm<double> arm{};
    if (make_arm(with_errors(geometry, random, 1e-3, 0.1 * deg), arm) != Status::ok) std::abort();
    double q[6];
    random_posture(arm, random, q);
    std::vector<Due> unmet;
    const Excursion found = there_and_back(arm, q, far_m, 0.00025, limit, &unmet);
    if (found.unique) ++unique;
    if (found.away_rad > 0.05) ++(found.unique ? unique_lost : other_lost);
    if (found.unique && found.away_rad <= 0.05) away = std::max(away, found.away_rad);
    unreachable += found.unreachable;
    evaluations += found.evaluations;
    most = std::max<int>(most, found.most);
    wavering += found.wavering;
    TickOptions<double> options = servo_options(arm);
    std::fill(options.limits.max_step, options.limits.max_step + 6, limit);
    const double regular_s = median_duration(arm, options, random);
    for (const Due& due : unmet) costs.push_back(duration(arm, options, due) / regular_s);
  }
  std::sort(costs.begin(), costs.end());
  const auto at = [&](double part) { return costs[static_cast<std::size_t>(part * static_cast<double>(costs.size() - 1))]; };
  std::printf("out of reach and back, %s, limit %g, %d postures: unique %d, of them elsewhere %d, others away %.1e rad; not "
              "unique %d, elsewhere %d; evaluations of an unreachable tick %.1f, %d at most; time over a regular one's: "
              "median %.1f, 99 of 100 below %.1f, 999 of 1000 below %.1f, over 8 %.3f %%; wavering %.2f %%\n",
              name, limit, arms, unique, unique_lost, away, arms - unique, other_lost,
              static_cast<double>(evaluations) / static_cast<double>(std::max(1L, unreachable)), most,
              at(0.5), at(0.99), at(0.999),
              100.0 * static_cast<double>(costs.end() - std::upper_bound(costs.begin(), costs.end(), 8.0)) /
                  static_cast<double>(costs.size()),
              100.0 * static_cast<double>(wavering) / static_cast<double>(std::max(1L, unreachable)));
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const long count = argc > 1 ? std::atol(argv[1]) : 10000;
  const std::uint64_t seed = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1;
  for (const double errors_mm : {0.1, 1.0, 5.0}) {
    arcs("UR5", ur5(), true, errors_mm, 50, seed + 10);
    arcs("spherical wrist", wrist_arm(), false, errors_mm, 50, seed + 11);
  }
  for (const double limit : {servo_step, 1.0}) {
    excursions("UR5", ur5(), 1.5, limit, 50, seed + 12);
    excursions("spherical wrist", wrist_arm(), 2.0, limit, 50, seed + 13);
  }
  for (const double errors_mm : {0.1, 1.0, 5.0}) {
    Random random(seed);
    std::vector<Arm<double>> arms(50);
    for (Arm<double>& arm : arms) {
      if (make_arm(with_errors(ur5(), random, errors_mm * 1e-3, errors_mm * 0.1 * deg), arm) != Status::ok) return 1;
    }
    char name[32];
    std::snprintf(name, sizeof name, "errors %.1f mm", errors_mm);
    all(name, arms, count, seed);
  }
  for (int i = 3; i < argc; ++i) {
    Arm<double> arm{};
    const offline::Robot robot = offline::read_robot(argv[i]);
    if (robot.geometry.joint_count != 6 || make_arm(robot.geometry, arm) != Status::ok) return 1;
    all(robot.name, {arm}, count, seed);
  }
  std::vector<Arm<double>> nominal(1);
  if (make_arm(ur5(), nominal[0]) != Status::ok) return 1;
  sweep("nominal, exactly singular", nominal, Where::singular, 0, count, seed + 4);
  long solved = 0;
  Random random(seed + 5);
  const long cold = std::max(1L, count / 10);
  for (long n = 0; n < cold; ++n) {
    Arm<double> arm{};
    if (make_arm(with_errors(n % 2 == 0 ? ur5() : wrist_arm(), random, 1e-3, 0.1 * deg), arm) != Status::ok) return 1;
    double q[6];
    Pose<double> target{};
    for (double& joint : q) joint = random.symmetric(pi);
    if (forward(arm, q, target) != Status::ok) return 1;
    for (double& joint : q) joint = random.symmetric(pi);
    if (cold_start(arm, default_solution_options(arm), target, q) == Status::ok) ++solved;
  }
  std::printf("cold start: %ld of %ld\n", solved, cold);
}
