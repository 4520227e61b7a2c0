// SPDX-License-Identifier: MIT
// What the commands on a blob have in common: the arm, and the frame and point in which poses are given.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "mdhcal/blob.hpp"
#include "mdhcal/kinematics.hpp"
#include "offline/output/blob_file.hpp"

namespace mdhcal::offline {

/// --frame and --target as given.
struct PoseOptions {
  std::string frame = "base";
  std::string target;
  bool has_target = false;

  /// Adds the two options to a command; `this` must outlive it.
  void add_to(CLI::App& command);
};

/// A warning if the blob was made with `calibrate --accept`: the reason that was given for it.
void warn_of_acceptance(const BlobFile& file);

/// A blob ready for use: its arm and the transforms that --frame and --target ask for.
struct BlobArm {
  mdhcal::BlobContent model;
  Arm<double> arm;               ///< with the transmission's terms; refers to `terms`
  std::shared_ptr<const JointFunctionTable> terms;
  Frame<double> world_T_base;    ///< world: the frame that --frame names
  Frame<double> flange_T_target; ///< a translation

  Frame<double> world_T_target(const Pose<double>& base_T_flange) const;
  Pose<double> base_T_flange(const Pose<double>& world_T_target) const;
};

/// Reads the blob. Throws InputError if it is refused, or has no base frame or target as asked for.
BlobArm read_blob_arm(const std::string& path, const PoseOptions& options);

/// Says what a table's reader noted.
void inform_all(const std::vector<std::string>& notes);

/// The enumerator's name, "near_singular": one word for the status column.
std::string status_word(Status status);

}  // namespace mdhcal::offline
