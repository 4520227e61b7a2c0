// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>

namespace mdhcal::offline {

/// A unit of a file: SI value = value * multiply / divide.
struct Unit {
  std::string_view name;
  double multiply;
  double divide;

  double to_si(double value) const { return value * multiply / divide; }
  /// The value that to_si() turns into the bits of `si`, the one with the fewest digits; where no value does (a
  /// division has gaps), the nearest.
  double from_si(double si) const;
  /// `si` moved by at most an ulp or two to a value that the unit can express: from_si() is then exact.
  double expressible(double si) const { return to_si(from_si(si)); }
};

inline constexpr double pi = 3.14159265358979323846;
/// For what is shown or given once; what is read back bit by bit goes through Unit.
inline constexpr double mm_per_m = 1e3;
inline constexpr double deg_per_rad = 180.0 / pi;
inline constexpr double rad_per_deg = pi / 180.0;

inline constexpr Unit metre{"m", 1.0, 1.0};
inline constexpr Unit millimetre{"mm", 1.0, 1000.0};
inline constexpr Unit radian{"rad", 1.0, 1.0};
inline constexpr Unit degree{"deg", pi, 180.0};
inline constexpr Unit plain_number{"", 1.0, 1.0};

/// The unit of a coupling's ratio: the coupled joint's unit over that of the joint whose reading it multiplies.
inline constexpr Unit coupling_unit(const Unit& of, const Unit& by) {
  return of.name == by.name ? plain_number : Unit{"", of.multiply * by.divide, of.divide * by.multiply};
}

/// The shortest decimal that reads back as the same bits, with a point or an exponent, as TOML asks of a float.
std::string shortest_decimal(double value);

}  // namespace mdhcal::offline
