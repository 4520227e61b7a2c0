// SPDX-License-Identifier: MIT
// Joints of a six-joint arm drawn where a test wants them: away from every singularity, or near one of the three.
#pragma once

#include "tests/lib/every_solution.hpp"

namespace mdhcal::test {

/// Which singularity the joints are near: smallest singular value (lengths over the reach) below 0.01; else above it.
enum class Near { nothing, wrist, elbow, shoulder };

/// Uniform joints; near a singularity, joint 5, 3 or 2 is moved to a change of sign of the determinant along it and up to
/// 0.01 rad away again.
inline Joints sampled_joints(const Arm<double>& arm, Near near, Random& random) {
  constexpr double singular = 0.01;
  constexpr int steps = 36;
  for (;;) {
    Joints q;
    for (double& joint : q) joint = random.symmetric(pi);
    if (near == Near::nothing) {
      if (smallest_singular_value(arm, q.data()) >= singular) return q;
      continue;
    }
    const std::size_t joint = near == Near::wrist ? 4 : (near == Near::elbow ? 2 : 1);
    const auto sign_at = [&](double angle) {
      Joints at = q;
      at[joint] = angle;
      return determinant_sign(arm, at.data()) < 0;
    };
    const double start = q[joint];
    for (int step = 0; step < steps; ++step) {
      double low = start + 2 * pi / steps * step;
      double high = start + 2 * pi / steps * (step + 1);
      const bool at_low = sign_at(low);
      if (at_low == sign_at(high)) continue;
      for (int halving = 0; halving < 40; ++halving) {
        const double middle = 0.5 * (low + high);
        (sign_at(middle) == at_low ? low : high) = middle;
      }
      q[joint] = std::remainder(low + random.symmetric(0.01), 2 * pi);
      if (smallest_singular_value(arm, q.data()) < singular) return q;
      break;
    }
  }
}

}  // namespace mdhcal::test
