// SPDX-License-Identifier: MIT
#include <cmath>

#include "mdhcal/environment.hpp"
#include "meter.hpp"

namespace footprint {

namespace {

using namespace mdhcal;

Geometry geometry;
Transmission transmission;
JointFunctionTable table;

template <class Real>
void measure_preparation() {
  using S = State<Real>;
  static SolutionOptions<Real> solution_options;
  [[maybe_unused]] static ArmFamily found;
  const char* precision = precision_name<Real>;
  constexpr int count = input_count;
  const auto another = [](int i) {
    geometry = calibrated_arm(static_cast<std::uint64_t>(i) + 1);
    S::status = make_arm(geometry, S::arm);
  };
  measure("make_arm", precision, "arms", count, another, [] { S::status = make_arm(geometry, S::arm); });
  measure("make_calibrated_arm", precision, "arms", count, another,
          [] { S::status = make_calibrated_arm(geometry, geometry, S::calibrated); });
  measure("default_tick_options", precision, "arms", count, another, [] { S::options = default_tick_options(S::arm); });
  measure("default_solution_options", precision, "arms", count, another,
          [] { solution_options = default_solution_options(S::arm); });
  measure("family_of", precision, "arms", count, another, [] { found = family_of(S::arm); });
}

// What is measured on the arm without terms and on the one with all of them.
struct Names {
  const char *forward, *with_jacobian, *link_frames, *tick;
};
constexpr Names plain{"forward", "forward+jacobian", "link_frames", "tick"};
constexpr Names all_terms{"forward+terms", "forward+jacobian+terms", "link_frames+terms", "tick+terms"};

template <class Real>
void measure_kinematics(const Names& names) {
  using S = State<Real>;
  static Jacobian<Real> jacobian;
  static Frame<Real> frames[max_joints + 2];
  const char* precision = precision_name<Real>;
  for (Set set : {Set::regular, Set::near_singular}) {
    Random random(1);
    const auto prepare = [&](int i) {
      double q_rad[6];
      joints(set, i, random, q_rad);
      S::set_joints(q_rad);
    };
    measure(names.forward, precision, name_of(set), input_count, prepare, [] { S::status = forward(S::arm, S::q, S::pose); });
    measure(names.with_jacobian, precision, name_of(set), input_count, prepare,
            [] { S::status = forward(S::arm, S::q, S::pose, jacobian); });
    measure(names.link_frames, precision, name_of(set), input_count, prepare,
            [] { S::status = link_frames(S::arm, S::q, frames); });
  }
}

// One tick at 1 kHz: targets up to 3 mrad a joint away, or anywhere.
template <class Real>
void measure_tick(const Names& names) {
  using S = State<Real>;
  static TickReport<Real> report;
  const auto call = [] { S::status = tick(S::arm, S::options, S::pose, S::q, &report); };
  S::options = default_tick_options(S::arm);
  S::limit_steps();
  Random random(2);
  double q_rad[6], target_rad[6];
  for (Set set : {Set::regular, Set::near_singular}) {
    const auto prepare = [&](int i) {
      joints(set, i, random, q_rad);
      for (int k = 0; k < 6; ++k) target_rad[k] = q_rad[k] + random.uniform(-0.003, 0.003);
      S::set_joints(target_rad);
      S::status = forward(S::arm, S::q, S::pose);
      S::set_joints(q_rad);
    };
    measure(names.tick, precision_name<Real>, name_of(set), tick_count<Real>, prepare, call);
  }
  const auto far = [&](int i) {
    joints(Set::mixed, i, random, q_rad);
    S::set_joints(q_rad);
    S::status = forward(S::arm, S::q, S::pose);
    for (Real& p : S::pose.position_m) p = static_cast<Real>(random.uniform(-2, 2));
    joints(i % 3 == 0 ? Set::regular : Set::near_singular, i, random, q_rad);
    S::set_joints(q_rad);
  };
  measure(names.tick, precision_name<Real>, "far", tick_count<Real>, far, call);
  // Straight away from the base until out of reach, and back, 0.3 mm a tick; every fortieth is measured.
  constexpr int excursion = 100, skipped = 40;
  static Pose<Real> home;
  static Real home_m;
  const auto along_border = [&](int i) {
    if (i % excursion == 0) {
      joints(Set::regular, i, random, q_rad);
      S::set_joints(q_rad);
      S::status = forward(S::arm, S::q, home);
      const Real* p = home.position_m;
      home_m = std::sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
    }
    S::pose = home;
    for (int k = 0; k < skipped; ++k) {
      const int at = (i % excursion) * skipped + k;
      const int away = std::min(at, excursion * skipped - at);
      for (int c = 0; c < 3; ++c) {
        S::pose.position_m[c] = home.position_m[c] * (1 + static_cast<Real>(3e-4) * static_cast<Real>(away) / home_m);
      }
      if (k + 1 < skipped) call();
    }
  };
  measure(names.tick, precision_name<Real>, "border", tick_count<Real>, along_border, call);
}

}  // namespace

void measure_arm() {
  measure("check_environment", "-", "once", 1, [](int) {}, [] { State<float>::status = check_environment(); });
  measure("check", "-", "arms", input_count, [](int i) { geometry = calibrated_arm(static_cast<std::uint64_t>(i) + 1); },
          [] { State<float>::status = check_geometry(geometry); });
  measure_preparation<double>();
  measure_preparation<float>();
  geometry = calibrated_arm();
  State<double>::status = make_arm(geometry, State<double>::arm);
  State<float>::status = make_arm(geometry, State<float>::arm);
  measure_kinematics<double>(plain);
  measure_kinematics<float>(plain);
  measure_tick<double>(plain);
  measure_tick<float>(plain);
  every_term(transmission);
  make_table(transmission, table);
  State<double>::status = make_arm(geometry, transmission, table, State<double>::arm);
  State<float>::status = make_arm(geometry, transmission, table, State<float>::arm);
  State<double>::status = set_payload(State<double>::arm, 3.0);
  State<float>::status = set_payload(State<float>::arm, 3.0F);
  measure_kinematics<double>(all_terms);
  measure_kinematics<float>(all_terms);
  measure_tick<double>(all_terms);
  measure_tick<float>(all_terms);
}

}  // namespace footprint
