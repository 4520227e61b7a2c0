// SPDX-License-Identifier: MIT
// The unknowns beyond geometry: coefficients of joint functions and of the joints' sag under gravity.
#pragma once

#include <cstdint>
#include <vector>

#include "mdhcal/transmission.hpp"

namespace mdhcal::offline {

/// Which family a parameter belongs to: all of one family have one prior variance.
enum class TermFamily : std::int32_t { geometry = 0, gravity, orders_1_2, orders_3_10, orders_11_20, orders_21_40 };
inline constexpr std::size_t family_count = 6;

/// One coefficient of the transmission.
struct Term {
  TermFamily family = TermFamily::gravity;
  std::int32_t joint = 0;
  std::int32_t index = 0;   ///< gravity: the link j; a joint function: its order, from 1
  bool sine = false;
  double prior = 1e-3;      ///< unit of the column [rad], gravity [rad/m]
};

TermFamily family_of_order(std::size_t order);
double value(const Transmission& transmission, const Term& term);
void add_value(Transmission& transmission, const Term& term, double by);

/// The window w of a joint function at a reading [rad].
double window_at(const JointFunction& function, double reading_rad);

}  // namespace mdhcal::offline
