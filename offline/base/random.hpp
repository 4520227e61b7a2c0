// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <cstdint>
#include <random>

namespace mdhcal::offline {

/// Random numbers that a seed determines on every machine. std::mt19937_64 is fixed by the standard, the std::
/// distributions are not, so uniform and normal numbers are derived here.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  /// A 64-bit word, all bits random.
  std::uint64_t bits() { return engine_(); }

  /// Uniform in [0, 1), a multiple of 2^-53.
  double uniform() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }

  /// Uniform in [low, high).
  double uniform(double low, double high) { return low + (high - low) * uniform(); }

  /// Uniform in 0 ... count - 1; count >= 1. The bias, below count / 2^53, is left in.
  std::size_t index(std::size_t count) {
    return static_cast<std::size_t>(uniform() * static_cast<double>(count));
  }

  /// Normal, mean 0 and standard deviation 1, by the polar method (Marsaglia & Bray 1964). Only log() can differ
  /// between machines, by its last bit.
  double normal() {
    if (spare_held_) {
      spare_held_ = false;
      return spare_;
    }
    double u = 0, v = 0, s = 0;
    do {
      u = uniform(-1, 1);
      v = uniform(-1, 1);
      s = u * u + v * v;
    } while (s >= 1 || s <= 0);
    const double factor = std::sqrt(-2 * std::log(s) / s);
    spare_ = v * factor;
    spare_held_ = true;
    return u * factor;
  }

 private:
  std::mt19937_64 engine_;
  double spare_ = 0;
  bool spare_held_ = false;
};

}  // namespace mdhcal::offline
