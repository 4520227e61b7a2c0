// SPDX-License-Identifier: MIT
// The warm tick beside two plain loops (plain_loops.hpp), on the same poses in one run: `bench_tick [POSES] [SEED]` prints
// medians and 99th percentiles in ns, what was missed, and the ratios that docs/real-time.md quotes. 50 UR5-like arms with
// errors of 1 mm and 0.1 degrees, seeds within 3.14 mrad a joint, all to 1e-10; near singular: joint 3 or 5 within 0.01 rad
// of zero. Each pose is solved `repeats` times a solver, the solvers by turns, so that what else the machine does falls on
// all of them alike; the least of the times counts.
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "mdhcal/inverse.hpp"
#include "mdhcal/kinematics.hpp"
#include "tests/bench/plain_loops.hpp"
#include "tests/lib/arms.hpp"

namespace {

using namespace mdhcal;
using namespace mdhcal::test;

constexpr double tolerance = 1e-10;
constexpr int arm_count = 50, repeats = 7;

struct Case {
  std::size_t arm;
  Pose<double> target;
  bench::PlainLoops::Frame34 frame;
  std::array<double, 6> seed;
};

struct Result {
  std::vector<double> ns;
  long missed = 0;
  double at(double part) {
    std::sort(ns.begin(), ns.end());
    return ns[static_cast<std::size_t>(part * static_cast<double>(ns.size() - 1))];
  }
};

double ns_between(std::chrono::steady_clock::time_point a, std::chrono::steady_clock::time_point b) {
  return std::chrono::duration<double, std::nano>(b - a).count();
}

template <class Solve>
double once(const Case& c, const Solve& solve, bool& met) {
  std::array<double, 6> q = c.seed;
  const auto begin = std::chrono::steady_clock::now();
  met = solve(c, q.data());
  const auto end = std::chrono::steady_clock::now();
  __asm volatile("" : : "m"(q) : "memory");
  return ns_between(begin, end);
}

template <class Library, class Newton, class Levenberg>
void compare(const char* name, const std::vector<Case>& cases, const Library& library, const Newton& newton,
             const Levenberg& levenberg, double clock_ns) {
  Result result[3];
  for (const Case& c : cases) {
    double least[3] = {1e9, 1e9, 1e9};
    bool met[3] = {false, false, false};
    for (int n = 0; n < repeats; ++n) {
      least[0] = std::min(least[0], once(c, library, met[0]));
      least[1] = std::min(least[1], once(c, newton, met[1]));
      least[2] = std::min(least[2], once(c, levenberg, met[2]));
    }
    for (int i = 0; i < 3; ++i) {
      result[i].ns.push_back(least[i] - clock_ns);
      result[i].missed += met[i] ? 0 : 1;
    }
  }
  const char* const solver[] = {"library", "plain Newton, LU", "plain Levenberg-Marquardt"};
  for (int i = 0; i < 3; ++i) {
    std::printf("%-14s %-26s median %6.0f ns, p99 %6.0f ns, missed %ld of %zu, library over it %.3f\n", name, solver[i],
                result[i].at(0.5), result[i].at(0.99), result[i].missed, cases.size(),
                result[0].at(0.5) / result[i].at(0.5));
  }
}

}  // namespace

int main(int argc, char** argv) {
  const int poses = argc > 1 ? std::atoi(argv[1]) : 4000;
  Random random(argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 51);
  std::vector<Arm<double>> arms(arm_count);
  std::vector<bench::PlainLoops> plain;
  for (Arm<double>& arm : arms) {
    const Geometry g = with_errors(ur5(), random, 1e-3, 0.1 * deg);
    if (make_arm(g, arm) != Status::ok) return 1;
    plain.emplace_back(g);
  }
  double clock_ns = 1e9;
  for (int n = 0; n < 10000; ++n) {
    const auto begin = std::chrono::steady_clock::now();
    clock_ns = std::min(clock_ns, ns_between(begin, std::chrono::steady_clock::now()));
  }
  const auto library = [&](const Case& c, double* q) {
    return tick(arms[c.arm], default_tick_options(arms[c.arm]), c.target, q) == Status::ok;
  };
  const auto newton = [&](const Case& c, double* q) { return plain[c.arm].newton(c.frame, q, tolerance); };
  const auto levenberg = [&](const Case& c, double* q) { return plain[c.arm].levenberg(c.frame, q, tolerance); };
  for (const bool near_singular : {false, true}) {
    std::vector<Case> cases;
    for (int n = 0; n < poses; ++n) {
      Case c{};
      c.arm = static_cast<std::size_t>(n % arm_count);
      for (double& joint : c.seed) joint = random.symmetric(pi);
      // Regular: elbow and wrist at least 0.3 rad from straight.
      for (const std::size_t joint : {std::size_t{2}, std::size_t{4}}) {
        c.seed[joint] = (c.seed[joint] < 0 ? -1 : 1) * random.uniform(0.3, 2.8);
      }
      if (near_singular) c.seed[n % 2 == 0 ? 2 : 4] = random.symmetric(0.01);
      double column[6][6];
      plain[c.arm].forward(c.seed.data(), c.frame, column);
      if (forward(arms[c.arm], c.seed.data(), c.target) != Status::ok) return 1;
      for (double& joint : c.seed) joint += random.symmetric(0.00314);
      cases.push_back(c);
    }
    compare(near_singular ? "near singular" : "regular", cases, library, newton, levenberg, clock_ns);
  }
}
