// SPDX-License-Identifier: MIT
// Prints what each function costs: a line a function, precision and input set.
#include <algorithm>
#include <array>
#include <cstdio>
#include <type_traits>

#include "counter.hpp"
#include "inputs.hpp"
#include "mdhcal/kinematics.hpp"

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
  static inline Pose<Real> pose;
  static inline Jacobian<Real> jacobian;
  static inline Frame<Real> frames[max_joints + 2];
  static inline Status status;
};

template <class Real>
void set_joints(const double (&q_rad)[6]) {
  for (int k = 0; k < 6; ++k) State<Real>::q[k] = static_cast<Real>(q_rad[k]);
}

Geometry geometry;

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

}  // namespace

int main() {
  start_counter();
  overhead = raw_instructions(nothing);
  geometry = calibrated_arm();
  measure_kinematics<double>();
  measure_kinematics<float>();
}
