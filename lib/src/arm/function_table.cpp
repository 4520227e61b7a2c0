// SPDX-License-Identifier: MIT
#include "mdhcal/arm.hpp"

#include "number/trigonometry.hpp"

namespace mdhcal {

namespace {

constexpr int nodes = static_cast<int>(sector_terms);
constexpr double pi = 3.14159265358979323846;

// The polynomial that meets the function in the Chebyshev points of the second kind, the sector's ends among them
// (Trefethen 2013, ch. 3). Beside the best one of its degree it loses a factor of two.
struct Interpolation {
  double point[nodes];        // u_m = cos(pi m / (nodes - 1))
  double term[nodes][nodes];  // coefficient of u^k = sum_m term[k][m] f(u_m)
};

void make(Interpolation& to) {
  constexpr int last = nodes - 1;
  double chebyshev[nodes][nodes];  // [k][m]: what f(u_m) has in the coefficient of T_k
  double sine = 0.0;
  for (int m = 0; m <= last; ++m) {
    sin_cos(pi * static_cast<double>(m) / static_cast<double>(last), sine, to.point[m]);
    for (int k = 0; k <= last; ++k) {
      double cosine = 0.0;
      sin_cos(pi * static_cast<double>(m * k) / static_cast<double>(last), sine, cosine);
      const double half = (m == 0 || m == last ? 0.5 : 1.0) * (k == 0 || k == last ? 0.5 : 1.0);  // ends count half
      chebyshev[k][m] = 2.0 / static_cast<double>(last) * half * cosine;
    }
  }
  // T_{k+1} = 2 u T_k - T_{k-1} in powers of u.
  double before[nodes] = {}, now[nodes] = {1.0};
  for (int k = 0; k <= last; ++k) {
    for (int power = 0; power <= last; ++power) {
      for (int m = 0; m <= last; ++m) {
        to.term[power][m] = (k == 0 ? 0.0 : to.term[power][m]) + now[power] * chebyshev[k][m];
      }
    }
    double next[nodes];
    for (int power = 0; power <= last; ++power) {
      next[power] = (k == 0 ? 1.0 : 2.0) * (power > 0 ? now[power - 1] : 0.0) - before[power];
    }
    for (int power = 0; power <= last; ++power) {
      before[power] = now[power];
      now[power] = next[power];
    }
  }
}

}  // namespace

void make_table(const Transmission& transmission, JointFunctionTable& table) noexcept {
  Interpolation interpolation;
  make(interpolation);
  constexpr double sector_rad = 2.0 * pi / static_cast<double>(turn_sectors);
  for (std::size_t i = 0; i < max_joints; ++i) {
    const JointFunction& f = transmission.function[i];
    for (std::int32_t s = 0; s < turn_sectors; ++s) {
      float* coefficient = table.coefficient[i][s];
      for (int k = 0; k < nodes; ++k) coefficient[k] = 0.0F;
      if (f.order_count < 1) continue;
      double value[nodes], slope = 0.0;
      for (int m = 0; m < nodes; ++m) {
        const double reading = (static_cast<double>(s) + 0.5 + 0.5 * interpolation.point[m]) * sector_rad;  // point: -1 ... 1
        evaluate_joint_function(f, reading, value[m], slope);
      }
      for (int k = 0; k < nodes; ++k) {
        double sum = 0.0;
        for (int m = 0; m < nodes; ++m) sum += interpolation.term[k][m] * value[m];
        coefficient[k] = static_cast<float>(sum);
      }
    }
  }
}

}  // namespace mdhcal
