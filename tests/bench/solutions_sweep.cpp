// SPDX-License-Identifier: MIT
// How complete find_solutions() is: `bench_solutions_sweep POSES [SEED] [ROBOT.toml ...]` prints a line a workload. Truth: the
// joints that the pose came from, and what Levenberg-Marquardt reaches from 400 random ones (tests/lib/every_solution.hpp).
// Then cold starts from random joints. MDHCAL_ROWS=TEXT runs only the lines whose name holds TEXT, MDHCAL_SHOW_LOST=1
// prints each solution that was not found. A thinned version runs in tests/lib.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>

#include "mdhcal/solutions.hpp"
#include "offline/robot/robot.hpp"
#include "tests/lib/every_solution.hpp"
#include "tests/lib/sampled_pose.hpp"

namespace {

using namespace mdhcal;
using namespace mdhcal::test;

constexpr int truth_restarts = 400;

struct Counts {
  long poses = 0, complete = 0, solutions = 0, lost = 0, beyond_truth = 0, false_claims = 0;
  double seconds = 0;
};

void describe(const Arm<double>& arm, const Joints& lost, const Solutions<double>& found) {
  double nearest = 9;
  for (int k = 0; k < found.count; ++k) nearest = std::min(nearest, turn_distance(found.q[k], lost.data(), 6));
  std::printf("  lost: sigma %.2e, nearest found %.3f of %d, q", smallest_singular_value(arm, lost.data()), nearest,
              found.count);
  for (const double joint : lost) std::printf(" %.4f", std::remainder(joint, 2 * pi));
  std::printf("\n");
}

void one(const Arm<double>& arm, Near near, Random& random, int restarts, bool verbose, Counts& counts) {
  const Joints q = sampled_joints(arm, near, random);
  Pose<double> target{};
  if (forward(arm, q.data(), target) != Status::ok) std::abort();
  std::vector<Joints> truth = every_solution(arm, target, truth_restarts, random);
  if (!holds(truth, q.data())) truth.push_back(q);
  double posture[6];
  for (double& joint : posture) joint = random.symmetric(pi);
  SolutionOptions<double> options = default_solution_options(arm);
  if (restarts >= 0) options.restarts = restarts;
  Solutions<double> found{};
  const auto before = std::chrono::steady_clock::now();
  if (find_solutions(arm, options, target, posture, found) == Status::bad_input) std::abort();
  counts.seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - before).count();
  long lost = 0;
  for (const Joints& solution : truth) {
    bool there = false;
    for (int k = 0; k < found.count; ++k) there = there || turn_distance(found.q[k], solution.data(), 6) < distinct_rad;
    if (there) continue;
    ++lost;
    if (verbose) describe(arm, solution, found);
  }
  for (int k = 0; k < found.count; ++k) {
    if (!holds(truth, found.q[k])) ++counts.beyond_truth;
    Pose<double> reached{};
    if (forward(arm, found.q[k], reached) != Status::ok || position_distance(reached, target) > 1.01e-10 ||
        small_angle(reached, target) > 1.01e-10) {
      ++counts.false_claims;
    }
  }
  ++counts.poses;
  counts.lost += lost;
  counts.solutions += static_cast<long>(truth.size());
  if (lost == 0) ++counts.complete;
}

bool wanted_row(const std::string& name) {
  const char* rows = std::getenv("MDHCAL_ROWS");
  return rows == nullptr || name.find(rows) != std::string::npos;
}

using MakeArm = std::function<Geometry(Random&)>;

void sweep(const std::string& name, const MakeArm& make, long poses, std::uint64_t seed, int restarts) {
  const bool verbose = std::getenv("MDHCAL_SHOW_LOST") != nullptr;
  const struct {
    const char* text;
    Near near;
  } kinds[] = {{"regular", Near::nothing}, {"wrist", Near::wrist}, {"elbow", Near::elbow}, {"shoulder", Near::shoulder}};
  for (const auto& kind : kinds) {
    if (kind.near != Near::nothing && restarts > 0) continue;
    if (!wanted_row(name + ", " + kind.text)) continue;
    Random random(seed);
    Counts c;
    for (long n = 0; n < poses; ++n) {
      Arm<double> arm{};
      if (make_arm(make(random), arm) != Status::ok) std::abort();
      one(arm, kind.near, random, restarts, verbose, c);
    }
    std::printf("%-32s %-9s %ld poses: complete %.3f %% (missed %ld), solutions %.2f a pose, lost %ld, beyond the truth "
                "%ld, false %ld, %.0f us\n",
                name.c_str(), kind.text, c.poses, 100.0 * static_cast<double>(c.complete) / static_cast<double>(c.poses),
                c.poses - c.complete, static_cast<double>(c.solutions) / static_cast<double>(c.poses), c.lost,
                c.beyond_truth, c.false_claims, 1e6 * c.seconds / static_cast<double>(c.poses));
    std::fflush(stdout);
  }
}

// Random poses of arms of both families with errors of 0.1, 1 and 5 mm, one in four near a singularity.
void cold_starts(long count, std::uint64_t seed) {
  if (!wanted_row("cold start")) return;
  Random random(seed);
  const Geometry kinds[] = {ur5(), wrist_arm(), published_robot(), puma560()};
  const double errors_mm[] = {0.1, 1.0, 5.0};
  const Near places[] = {Near::wrist, Near::elbow, Near::shoulder};
  long solved = 0;
  long false_claims = 0;
  for (long n = 0; n < count; ++n) {
    Arm<double> arm{};
    const double errors = errors_mm[n % 3];
    if (make_arm(with_errors(kinds[n % 4], random, errors * 1e-3, errors * 0.1 * deg), arm) != Status::ok) std::abort();
    Joints q = sampled_joints(arm, n % 16 < 12 ? Near::nothing : places[n % 3], random);
    Pose<double> target{};
    Pose<double> reached{};
    if (forward(arm, q.data(), target) != Status::ok) std::abort();
    const Joints from = q;
    for (double& joint : q) joint = random.symmetric(pi);
    if (cold_start(arm, default_solution_options(arm), target, q.data()) != Status::ok) {
      if (std::getenv("MDHCAL_SHOW_LOST") != nullptr) {
        std::printf("  lost: arm %ld of 4, %.1f mm, sigma %.2e, q", n % 4, errors, smallest_singular_value(arm, from.data()));
        for (const double joint : from) std::printf(" %.4f", joint);
        std::printf("\n");
      }
      continue;
    }
    ++solved;
    if (forward(arm, q.data(), reached) != Status::ok || position_distance(reached, target) > 1.01e-10 ||
        small_angle(reached, target) > 1.01e-10) {
      ++false_claims;
    }
  }
  std::printf("cold start: %ld of %ld, false %ld\n", solved, count, false_claims);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const long poses = argc > 1 ? std::atol(argv[1]) : 100;
  const std::uint64_t seed = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1;
  cold_starts(50 * poses, seed);
  const struct {
    const char* name;
    Geometry geometry[2];
  } kinds[] = {{"three parallel axes", {ur5(), published_robot()}}, {"spherical wrist", {wrist_arm(), puma560()}}};
  for (const auto& kind : kinds) {
    for (const double errors_mm : {0.1, 1.0, 5.0}) {
      char name[64];
      std::snprintf(name, sizeof name, "%s, %.1f mm", kind.name, errors_mm);
      long made = 0;
      sweep(name, [&](Random& random) {
        return with_errors(kind.geometry[made++ % 2], random, errors_mm * 1e-3, errors_mm * 0.1 * deg);
      }, poses, seed, -1);
    }
  }
  for (int i = 3; i < argc; ++i) {
    const offline::Robot robot = offline::read_robot(argv[i]);
    if (robot.geometry.joint_count != 6) return 1;
    sweep(robot.name, [&](Random&) { return robot.geometry; }, poses, seed, -1);
  }
  for (const int restarts : {100, 200, 400}) {
    sweep("no family, " + std::to_string(restarts) + " restarts", random_arm, poses, seed, restarts);
  }
}
