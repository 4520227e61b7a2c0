// SPDX-License-Identifier: MIT
// Which of the solutions of a pose a program means by its configuration flags.
#pragma once

#include <array>
#include <limits>
#include <optional>

#include "mdhcal/solutions.hpp"
#include "offline/filter/cold_start.hpp"

namespace mdhcal::offline {

inline constexpr double unbounded = std::numeric_limits<double>::infinity();
inline constexpr double one_degree_rad = 3.14159265358979323846 / 180;
inline constexpr double one_turn_rad = 360 * one_degree_rad;

/// Where a configuration lets a joint's reading be [rad].
struct ReadingRange {
  double least = -unbounded;
  double most = unbounded;
};

/// Axis 5 on the side of straight that a wrist's flag states: within half a turn, beyond which the sides change over.
inline constexpr ReadingRange wrist_positive{0, one_turn_rad / 2}, wrist_negative{-one_turn_rad / 2, 0};

/// What a program states about the joints of a pose, beside the pose. The reference is the arm at readings of
/// zero, with joints 2 and 3 a little above it.
struct Configuration {
  std::array<ReadingRange, max_joints> reading{};
  std::optional<bool> rear;   ///< the wrist's centre lies behind axis 1, seen from the side where it lies at the reference
  std::optional<bool> lower;  ///< the elbow lies on the other side of the line from shoulder to wrist than at the reference
};

/// The postures of one nominal arm. Shoulder and elbow are told on arms of the family spherical_wrist alone.
class Postures {
 public:
  /// The geometry is valid and has the nominal links.
  explicit Postures(const Geometry& nominal);

  const Arm<double>& arm() const { return arm_; }

  /// How far the readings are from what is stated [rad]: the sum of what joints lie outside their ranges, and one for a shoulder or an
  /// elbow on another side.
  double distance(const Configuration& stated, const Joints& q) const;

  /// The readings that meet the pose in the configuration: on the branch of `before`, if that is what is stated, or near where not all is
  /// stated; else of all solutions
  /// the one nearest to what is stated, and of those that fit alike the one the shortest way from `before` (root of the sum of squares,
  /// as no turn is worth another). not_converged if none fits to a degree.
  Solved solve(const Pose<double>& base_T_flange, const Configuration& stated, const Joints& before) const;

 private:
  struct Sides {
    double front_m, above_m2;
  };
  Sides sides(const Joints& q) const;

  Arm<double> arm_{};
  bool spherical_ = false;
  Arm<double> begin_[4]{};  // the arm's first 1, 2, 3 and 5 links
  double front_sign_ = 1, above_sign_ = 1;
};

}  // namespace mdhcal::offline
