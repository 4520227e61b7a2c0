// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <cstdint>
#include <random>

namespace mdhcal::tests {

/// Random numbers with the same values everywhere: the standard's engine, own distributions.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  std::uint64_t bits() { return engine_(); }
  /// 0 ... count - 1
  std::size_t below(std::size_t count) { return static_cast<std::size_t>(engine_() % count); }
  /// [low, high)
  double uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(engine_() >> 11U) * 0x1p-53);
  }
  /// Mean 0, standard deviation 1 (Box and Muller 1958).
  double normal() {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform(0, 1)));
    return radius * std::cos(uniform(0, 6.283185307179586));
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace mdhcal::tests
