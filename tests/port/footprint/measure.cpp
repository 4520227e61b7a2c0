// SPDX-License-Identifier: MIT
// Prints what each function costs: a line a function, precision and input set.
#include <algorithm>
#include <array>
#include <cstdio>
#include <type_traits>

#include "counter.hpp"
#include "golden_blobs.hpp"
#include "inputs.hpp"
#include "mdhcal/compensator.hpp"
#include "mdhcal/crc32.hpp"
#include "mdhcal/inverse.hpp"
#include "mdhcal/kinematics.hpp"
#include "mdhcal/port/store.hpp"
#include "mdhcal/self_test.hpp"
#include "mdhcal/solutions.hpp"

namespace {

using namespace footprint;
using namespace mdhcal;

std::uint32_t overhead = 0;
std::array<std::uint32_t, input_count> counts;

void nothing() {}

// `prepare` sets the input of one call; the call itself takes no argument.
template <class Prepare>
void measure(const char* name, const char* precision, const char* set, Prepare prepare, Call call,
             int count = input_count) {
  std::uint32_t stack = 0;
  for (int i = 0; i < count; ++i) {
    prepare(i);
    counts[static_cast<std::size_t>(i)] = raw_instructions(call) - overhead;
    prepare(i);
    stack = std::max(stack, painted_stack(call));
  }
  std::sort(counts.begin(), counts.begin() + count);
  std::printf("cost %s %s %s %lu %lu %lu %lu\n", name, precision, set, static_cast<unsigned long>(counts[0]),
              static_cast<unsigned long>(counts[static_cast<std::size_t>(count / 2)]),
              static_cast<unsigned long>(counts[static_cast<std::size_t>(count - 1)]),
              static_cast<unsigned long>(stack));
  std::fflush(stdout);
}

template <class Real>
struct State {
  static inline Arm<Real> arm;
  static inline Real q[max_joints];
  static inline Pose<Real> pose, target;
  static inline Jacobian<Real> jacobian;
  static inline Frame<Real> frames[max_joints + 2];
  static inline TickOptions<Real> options;
  static inline TickReport<Real> report;
  static inline CompensatorModel<Real> compensator;
  static inline CompensatorState<Real> ramp;
  static inline Pose<Real> command;
  static inline Real meant_q[max_joints];
  static inline Real velocity[6], max_velocity[max_joints], joint_velocity[max_joints];
  static inline SolutionOptions<Real> solution_options;
  static inline Solutions<Real> solutions;
  static inline Status status;
};

template <class Real>
void set_joints(const double (&q_rad)[6]) {
  for (int k = 0; k < 6; ++k) State<Real>::q[k] = static_cast<Real>(q_rad[k]);
}

Geometry geometry;

// One tick at 1 kHz: targets up to 3 mrad a joint away, or anywhere, with a step limit of pi mrad a joint.
template <class Real>
void measure_tick() {
  using S = State<Real>;
  const char* precision = std::is_same_v<Real, double> ? "double" : "float";
  const auto call = [] { S::status = tick(S::arm, S::options, S::pose, S::q, &S::report); };
  S::options = default_tick_options(S::arm);
  for (Real& step : S::options.max_step) step = static_cast<Real>(0.00314);
  double q_rad[6];
  Random random(2);
  // Double without an FPU for it is software, and no one's servo loop: fewer inputs there.
  constexpr int count = sizeof(Real) == 8 && (__ARM_FP & 8) == 0 ? input_count / 10 : input_count;
  bool second = false;  // every input is used twice: for the instructions, then for the stack
  for (Set set : {Set::regular, Set::near_singular}) {
    const auto prepare = [&](int) {
      if (!second) {
        double target_rad[6];
        joints(set, random, q_rad);
        for (int k = 0; k < 6; ++k) target_rad[k] = q_rad[k] + random.uniform(-0.003, 0.003);
        set_joints<Real>(target_rad);
        S::status = forward(S::arm, S::q, S::target);
      }
      second = !second;
      S::pose = S::target;
      set_joints<Real>(q_rad);
    };
    measure("tick", precision, set == Set::regular ? "regular" : "near-singular", prepare, call, count);
  }
  const auto far = [&](int i) {
    if (!second) {
      joints(i % 2 == 0 ? Set::regular : Set::near_singular, random, q_rad);
      set_joints<Real>(q_rad);
      S::status = forward(S::arm, S::q, S::target);
      for (Real& p : S::target.position_m) p = static_cast<Real>(random.uniform(-2, 2));
      joints(i % 3 == 0 ? Set::regular : Set::near_singular, random, q_rad);
    }
    second = !second;
    S::pose = S::target;
    set_joints<Real>(q_rad);
  };
  measure("tick", precision, "far", far, call, count);
}

template <class Real>
void measure_kinematics() {
  using S = State<Real>;
  const char* precision = std::is_same_v<Real, double> ? "double" : "float";
  measure("make_arm", precision, "any", [](int) {}, [] { S::status = make_arm(geometry, S::arm); }, 3);
  for (Set set : {Set::regular, Set::near_singular}) {
    const char* name = set == Set::regular ? "regular" : "near-singular";
    Random random(1);
    const auto prepare = [&](int) {
      double q_rad[6];
      joints(set, random, q_rad);
      set_joints<Real>(q_rad);
    };
    measure("forward", precision, name, prepare, [] { S::status = forward(S::arm, S::q, S::pose); });
    measure("forward+jacobian", precision, name, prepare,
            [] { S::status = forward(S::arm, S::q, S::pose, S::jacobian); });
    measure("link_frames", precision, name, prepare, [] { S::status = link_frames(S::arm, S::q, S::frames); });
  }
}

// The three forms of the compensator in the middle of its ramp, where the arm between the models is made in every tick.
template <class Real>
void measure_compensator() {
  using S = State<Real>;
  const char* precision = std::is_same_v<Real, double> ? "double" : "float";
  constexpr int count = input_count / 10;
  S::status = make_compensator(nominal_arm(), geometry, S::compensator);
  for (int i = 0; i < 6; ++i) {
    S::velocity[i] = static_cast<Real>(i % 2 == 0 ? 0.1 : -0.2);
    S::max_velocity[i] = 3;
  }
  Random random(4);
  double q_rad[6], meant_rad[6];
  bool second = false;
  const auto prepare = [&](int) {
    if (!second) {
      joints(Set::regular, random, meant_rad);
      for (int k = 0; k < 6; ++k) q_rad[k] = meant_rad[k] + random.uniform(-0.003, 0.003);
    }
    second = !second;
    set_joints<Real>(meant_rad);
    for (int k = 0; k < 6; ++k) S::meant_q[k] = S::q[k];
    S::status = forward(S::arm, S::meant_q, S::pose);
    set_joints<Real>(q_rad);
  };
  for (const bool ramping : {false, true}) {
    S::ramp = rest(S::compensator, !ramping);
    if (ramping) {
      S::status = start_ramp(S::ramp, true, 1);
      S::status = advance(S::ramp, static_cast<Real>(0.5));
    }
    const char* set = ramping ? "ramp" : "rest";
    measure("pose_to_joints", precision, set, prepare,
            [] { S::status = pose_to_joints(S::compensator, S::ramp, S::options, S::pose, S::q); }, count);
    measure("joints_to_joints", precision, set, prepare,
            [] { S::status = joints_to_joints(S::compensator, S::ramp, S::options, S::meant_q, S::q); }, count);
    measure("pose_to_pose", precision, set, prepare,
            [] { S::status = pose_to_pose(S::compensator, S::ramp, S::options, S::pose, S::q, S::command); }, count);
  }
  measure("joint_velocities", precision, "regular", prepare,
          [] { S::status = joint_velocities(S::arm, S::q, S::velocity, S::max_velocity, S::joint_velocity); }, count);
}

// From nowhere: regular poses and near-singular ones by turns, the posture anywhere.
template <class Real>
void measure_solutions() {
  using S = State<Real>;
  const char* precision = std::is_same_v<Real, double> ? "double" : "float";
  constexpr int count = input_count / 50;
  S::solution_options = default_solution_options(S::arm);
  Random random(3);
  double q_rad[6];
  bool second = false;
  const auto prepare = [&](int i) {
    if (!second) {
      joints(i % 2 == 0 ? Set::regular : Set::near_singular, random, q_rad);
      set_joints<Real>(q_rad);
      S::status = forward(S::arm, S::q, S::pose);
      joints(Set::regular, random, q_rad);
    }
    second = !second;
    set_joints<Real>(q_rad);
  };
  measure("find_solutions", precision, "mixed", prepare,
          [] { S::status = find_solutions(S::arm, S::solution_options, S::pose, S::q, S::solutions); }, count);
  measure("cold_start", precision, "mixed", prepare,
          [] { S::status = cold_start(S::arm, S::solution_options, S::pose, S::q); }, count);
}

Model model;
std::uint8_t buffer[blob_size];
StoreState store_state;

// A flash in memory that does nothing but hold bytes: what is left is the store's own cost.
constexpr FlashGeometry flash_geometry{32, 8192, 2, 0xFF};
std::uint8_t flash_bytes[2 * 8192];

Status read_flash(void*, std::uint32_t address, std::uint8_t* to, std::uint32_t size) {
  std::copy_n(flash_bytes + address, size, to);
  return Status::ok;
}
Status program_flash(void*, std::uint32_t address, const std::uint8_t* granule) {
  std::copy_n(granule, flash_geometry.granule_bytes, flash_bytes + address);
  return Status::ok;
}
Status erase_flash(void*, std::uint32_t address) {
  std::fill_n(flash_bytes + address, flash_geometry.sector_bytes, flash_geometry.erased_value);
  return Status::ok;
}
constexpr Flash memory_flash{flash_geometry, read_flash, program_flash, erase_flash, nullptr};
constexpr Loader any_blob{[](const std::uint8_t*, std::size_t, void*) { return Status::ok; }, nullptr};

void measure_blob() {
  static Status status;
  constexpr int times = 3;
  const auto as_it_is = [](int) {};
  const auto& bytes = golden::six_joints;
  measure("crc32", "-", "blob", as_it_is, [] { store_state.sequence = crc32(golden::six_joints, blob_size); }, times);
  measure("decode", "-", "golden", as_it_is,
          [] { status = decode(golden::six_joints, blob_size, DecodeOptions{}, model); }, times);
  if (decode(bytes, blob_size, DecodeOptions{}, model) != Status::ok) std::printf("the golden blob is refused\n");
  status = make_arm(model.geometry, State<double>::arm);
  status = make_arm(model.geometry, State<float>::arm);
  measure("self_test", "double", "golden", as_it_is, [] { status = self_test(model, State<double>::arm); }, times);
  measure("self_test", "float", "golden", as_it_is, [] { status = self_test(model, State<float>::arm); }, times);
  std::fill(std::begin(flash_bytes), std::end(flash_bytes), flash_geometry.erased_value);
  store_state = {1, -1, 0, {Status::ok, Status::ok}};
  measure("update", "-", "memory", as_it_is,
          [] { status = update(memory_flash, any_blob, golden::six_joints, blob_size, store_state); }, times);
  measure("load_newest", "-", "memory", as_it_is,
          [] { status = load_newest(memory_flash, any_blob, buffer, store_state); }, times);
  if (status != Status::ok) std::printf("the store does not load\n");
}

}  // namespace

int main() {
  start_counter();
  overhead = raw_instructions(nothing);
  geometry = calibrated_arm();
  measure_kinematics<double>();
  measure_kinematics<float>();
  measure_tick<double>();
  measure_tick<float>();
  measure_compensator<double>();
  measure_compensator<float>();
#if (__ARM_FP & 8) != 0  // in software it is a thousand million instructions a call
  measure_solutions<double>();
#endif
  measure_solutions<float>();
  measure_blob();
  std::printf("complete\n");
}
