// SPDX-License-Identifier: MIT
#include "offline/filter/cold_start.hpp"

#include <algorithm>
#include <cmath>

namespace mdhcal::offline {

namespace {

SolutionOptions<double> thorough(const Arm<double>& arm) {
  SolutionOptions<double> options = default_solution_options(arm);
  // There is time here: restarts beside the closed form find what it misses near singularities.
  options.restarts = std::max(options.restarts, 100);
  return options;
}

// The largest difference of the joints, of turning ones modulo full turns.
double turn_distance(const Arm<double>& arm, const double* a, const double* b) {
  constexpr double full_turn = 6.28318530717958647692;
  double largest = 0.0;
  for (std::int32_t j = 0; j < arm.joint_count; ++j) {
    const double difference = a[j] - b[j];
    const bool slides = ((arm.prismatic_mask >> static_cast<std::uint32_t>(j)) & 1U) != 0U;
    largest = std::max(largest, std::abs(slides ? difference : std::remainder(difference, full_turn)));
  }
  return largest;
}

}  // namespace

Solved solve_from(const Arm<double>& arm, const Pose<double>& base_T_flange, const Joints& seed) {
  TickOptions<double> options = default_tick_options(arm);
  options.max_iterations = max_tick_iterations;
  Solved solved{seed, Status::not_converged};
  double before_m = 1e300, before_rad = 1e300;
  for (int ticks = 0; ticks < 20; ++ticks) {
    TickReport<double> report{};
    solved.status = tick(arm, options, base_T_flange, solved.q.data(), &report);
    if (solved.status == Status::ok || solved.status == Status::bad_input) break;
    const bool nearer = report.position_error_m < 0.9999 * before_m || report.rotation_error_rad < 0.9999 * before_rad;
    if (!nearer) break;
    before_m = report.position_error_m;
    before_rad = report.rotation_error_rad;
  }
  return solved;
}

Solved solve_near(const Arm<double>& arm, const Pose<double>& base_T_flange, const Joints& seed) {
  Solved solved = solve_from(arm, base_T_flange, seed);
  if (solved.status == Status::ok || solved.status == Status::bad_input) return solved;
  Solutions<double> found{};
  if (find_solutions(arm, thorough(arm), base_T_flange, seed.data(), found) != Status::ok) return solved;
  const double* nearest = found.q[0];
  for (std::int32_t k = 1; k < found.count; ++k) {
    if (turn_distance(arm, found.q[k], seed.data()) < turn_distance(arm, nearest, seed.data())) nearest = found.q[k];
  }
  std::copy(nearest, nearest + arm.joint_count, solved.q.begin());
  solved.status = Status::ok;
  return solved;
}

Solved solve_anew(const Arm<double>& arm, const Pose<double>& base_T_flange) {
  Solved solved;
  solved.status = cold_start(arm, thorough(arm), base_T_flange, solved.q.data());
  return solved.status == Status::out_of_reach ? solve_from(arm, base_T_flange, {}) : solved;
}

std::vector<Solved> solve_all(const Arm<double>& arm, const Pose<double>& base_T_flange) {
  Solutions<double> solutions{};
  std::vector<Solved> all;
  const Joints zero{};
  if (find_solutions(arm, thorough(arm), base_T_flange, zero.data(), solutions) != Status::ok) return all;
  for (std::int32_t k = 0; k < solutions.count; ++k) {
    Solved& solved = all.emplace_back();
    solved.status = Status::ok;
    std::copy(std::begin(solutions.q[k]), std::end(solutions.q[k]), solved.q.begin());
  }
  return all;
}

}  // namespace mdhcal::offline
