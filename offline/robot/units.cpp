// SPDX-License-Identifier: MIT
#include "offline/robot/units.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

namespace mdhcal::offline {

namespace {

bool same_bits(double a, double b) { return std::memcmp(&a, &b, sizeof a) == 0; }

double rounded(double value, int digits) {
  std::array<char, 40> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::scientific, digits - 1);
  double result = value;
  std::from_chars(text.data(), end.ptr, result);
  return result;
}

}  // namespace

double Unit::from_si(double si) const {
  const double guess = si * divide / multiply;
  if (!std::isfinite(guess)) return guess;
  for (int digits = 12; digits <= 16; ++digits) {
    const double value = rounded(guess, digits);
    if (same_bits(to_si(value), si)) return value;
  }
  // Three roundings lie between the guess and the value looked for: it is within a few ulps, if it exists.
  double best = guess;
  double up = guess;
  double down = guess;
  for (int step = 0; step <= 4; ++step) {
    for (const double value : {up, down}) {
      if (same_bits(to_si(value), si)) return value;
      if (std::abs(to_si(value) - si) < std::abs(to_si(best) - si)) best = value;
    }
    up = std::nextafter(up, std::numeric_limits<double>::infinity());
    down = std::nextafter(down, -std::numeric_limits<double>::infinity());
  }
  return best;
}

std::string shortest_decimal(double value) {
  std::array<char, 40> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value);
  std::string result(text.data(), end.ptr);
  if (result.find_first_of(".en") == std::string::npos) result += ".0";
  return result;
}

}  // namespace mdhcal::offline
