// SPDX-License-Identifier: MIT
// The long sweeps of the servo tick: `sweep COUNT [SEED] [ROBOT.toml ...]` prints a line a workload. Thinned versions run
// in tests/lib.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "mdhcal/solutions.hpp"
#include "offline/robot/robot.hpp"
#include "tests/lib/poses.hpp"

namespace {

using namespace mdhcal;
using namespace mdhcal::test;

constexpr double seed_bound = 0.00314;
constexpr double tolerance = 1e-6;

struct Counts {
  long ok = 0, other_branch = 0, false_claims = 0, over_limit = 0;
};

enum class Where { regular, wrist, elbow, singular };

double sigma(const Arm<double>& arm, const double* q) {
  // Out of its own pose the tick reports the smallest singular value within a factor of sqrt(6).
  Pose<double> pose{};
  TickReport<double> report{};
  double same[max_joints];
  std::copy(q, q + arm.joint_count, same);
  if (forward(arm, same, pose) != Status::ok) std::abort();
  if (tick(arm, default_tick_options(arm), pose, same, &report) == Status::bad_input) std::abort();
  return report.smallest_singular_value;
}

void one(const Arm<double>& arm, Where where, double limit, Random& random, Counts& counts) {
  double q[6];
  do {
    for (double& joint : q) joint = random.symmetric(pi);
    if (where == Where::wrist) q[4] = random.symmetric(0.01);
    if (where == Where::elbow) q[2] = random.symmetric(0.01);
    if (where == Where::singular) q[4] = 0;
  } while (where == Where::regular && sigma(arm, q) < 0.02);
  Pose<double> target{};
  if (forward(arm, q, target) != Status::ok) std::abort();
  double seed[6];
  for (int i = 0; i < 6; ++i) seed[i] = q[i] + (where == Where::singular && i == 4 ? 0 : random.symmetric(seed_bound));
  TickOptions<double> options = default_tick_options(arm);
  options.position_tolerance_m = options.rotation_tolerance_rad = tolerance;
  if (limit > 0) std::fill(options.max_step, options.max_step + 6, limit);
  double result[6];
  std::copy(seed, seed + 6, result);
  const Status status = tick(arm, options, target, result);
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

void sweep(const char* name, const std::vector<Arm<double>>& arms, Where where, double limit, long count,
           std::uint64_t seed) {
  Random random(seed);
  Counts counts;
  for (long n = 0; n < count; ++n) one(arms[static_cast<std::size_t>(n) % arms.size()], where, limit, random, counts);
  std::printf("%-34s %ld poses: ok %.4f %%, missed %ld, other branch %ld, false claims %ld, over the limit %ld\n", name,
              count, 100.0 * static_cast<double>(counts.ok) / static_cast<double>(count), count - counts.ok,
              counts.other_branch, counts.false_claims, counts.over_limit);
  std::fflush(stdout);
}

void all(const std::string& name, const std::vector<Arm<double>>& arms, long count, std::uint64_t seed) {
  sweep((name + ", regular").c_str(), arms, Where::regular, 0, count, seed);
  sweep((name + ", wrist").c_str(), arms, Where::wrist, 0, count, seed + 1);
  sweep((name + ", elbow").c_str(), arms, Where::elbow, 0, count, seed + 2);
  sweep((name + ", wrist, step limit").c_str(), arms, Where::wrist, seed_bound, count, seed + 3);
}

}  // namespace

int main(int argc, char** argv) {
  const long count = argc > 1 ? std::atol(argv[1]) : 10000;
  const std::uint64_t seed = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1;
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
