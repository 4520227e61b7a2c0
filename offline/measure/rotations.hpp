// SPDX-License-Identifier: MIT
// The conventions in which files state a rotation by three or four numbers, by name, and the way there and back.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace mdhcal::offline {

enum class RotationForm : std::int32_t {
  euler,       ///< three angles [rad] about axes of the frame
  vector,      ///< axis times angle [rad]
  quaternion,  ///< four plain numbers
};

/// How the numbers of a file state tracker_R_probe (columns: the probe's axes in the frame of the measurements).
struct RotationConvention {
  std::string name;                       ///< one of rotation_names(), with "-inverse" where `inverse`
  RotationForm form = RotationForm::vector;
  /// Euler: R = R_axis[0](n[0]) R_axis[1](n[1]) R_axis[2](n[2]), axes 0, 1, 2 for x, y, z (intrinsic: each turn is about
  /// an axis of the frame that the turns before have left). With `extrinsic` about axes that stay: the product reversed.
  std::array<std::int32_t, 3> axis{0, 1, 2};
  bool extrinsic = false;
  bool scalar_last = false;               ///< quaternion x, y, z, w instead of w, x, y, z
  bool inverse = false;                   ///< the numbers state probe_R_tracker
  bool radians = false;                   ///< angles without a stated unit are in radians, whatever the robot file says

  std::size_t count() const { return form == RotationForm::quaternion ? 4 : 3; }
  /// Whether the three turns are about three different axes: a column may then be told by its axis, rx, ry, rz.
  bool names_axes() const { return form != RotationForm::quaternion && axis[0] != axis[2]; }
};

/// Every name: orders such as "zyx" and "zyx-extrinsic" (twelve each), "vector", "quaternion", "quaternion-xyzw", and the
/// words of controllers: rpy, kuka, fanuc, staubli, abb, yaskawa, ur, comau, kawasaki, mitsubishi, epson.
const std::vector<std::string>& rotation_names();

/// The convention of a name, in small or capital letters, with "-inverse" behind it if the file states the inverse
/// rotation; empty if there is none of that name.
std::optional<RotationConvention> rotation_convention(std::string_view name);

/// The same; throws InputError with the list of names, saying that `option` named it.
RotationConvention require_rotation_convention(std::string_view name, const std::string& option);

/// The unit quaternion w, x, y, z, w >= 0, of numbers in the convention's order. A quaternion is normalised; of four
/// zeros the result is the identity.
std::array<double, 4> quaternion_from(const RotationConvention& convention, const std::array<double, 4>& numbers);

/// The inverse: numbers in the convention's order, [rad] or plain; the fourth is 0 where there are three. Angles lie in
/// (-pi, pi]; of Tait-Bryan angles the second lies in [-pi/2, pi/2], of proper Euler angles in [0, pi].
std::array<double, 4> numbers_of(const RotationConvention& convention, const std::array<double, 4>& quaternion);

/// Numbers of columns that are named by their axes (x, y, z) in the convention's order.
std::array<double, 4> ordered(const RotationConvention& convention, bool by_axis, const std::array<double, 4>& numbers);

}  // namespace mdhcal::offline
