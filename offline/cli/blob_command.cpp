// SPDX-License-Identifier: MIT
#include "offline/cli/blob_command.hpp"

#include <algorithm>

#include "offline/base/error.hpp"
#include "offline/cli/messages.hpp"
#include "offline/output/blob_file.hpp"
#include "offline/robot/arm_with_terms.hpp"
#include "offline/robot/rotation.hpp"

namespace mdhcal::offline {

namespace {

constexpr Frame<double> identity{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};

std::string names_of(const mdhcal::BlobContent& model) {
  std::string names;
  for (std::int32_t k = 0; k < model.target_count; ++k) {
    names += (k == 0 ? "\"" : ", \"") + std::string(model.target[k].name) + '"';
  }
  return names.empty() ? "none" : names;
}

}  // namespace

void PoseOptions::add_to(CLI::App& command) {
  command.add_option("--frame", frame, "Frame of the poses: the robot's base or that of the measurements")
      ->check(CLI::IsMember({"base", "tracker"}))
      ->capture_default_str();
  command.add_option_function<std::string>(
      "--target",
      [this](const std::string& name) {
        target = name;
        has_target = true;
      },
      "Target point of the blob that the positions are of; default the flange");
}

Frame<double> BlobArm::world_T_target(const Pose<double>& base_T_flange) const {
  return compose(compose(world_T_base, frame_of(base_T_flange)), flange_T_target);
}

Pose<double> BlobArm::base_T_flange(const Pose<double>& world_T_target) const {
  return pose_of(compose(compose(inverted(world_T_base), frame_of(world_T_target)), inverted(flange_T_target)));
}

void warn_of_acceptance(const BlobFile& file) {
  const std::string reason = accepted_reason(file.model.provenance);
  if (reason.empty()) return;
  warn("This blob comes from a result with reasons against it, accepted with the words \"" + reason +
       "\": its result.json says which.");
}

BlobArm read_blob_arm(const std::string& path, const PoseOptions& options) {
  BlobArm blob{read_blob(path), {}, nullptr, identity, identity};
  ArmWithTerms<double> prepared;
  if (prepare(blob.model.geometry, blob.model.transmission, prepared) != Status::ok) {
    throw InputError(path, 0, 0, "The couplings in the blob cannot be inverted, as its joint functions need it.");
  }
  blob.arm = prepared.arm;
  blob.terms = prepared.table;
  if (options.frame == "tracker") {
    if (blob.model.has_base == 0) {
      throw InputError(path, 0, 0, "The blob has no base frame (tracker_T_base); expected one for --frame tracker.");
    }
    blob.world_T_base = frame_of(blob.model.tracker_T_base);
  }
  if (options.has_target) {
    const Target* first = blob.model.target;
    const Target* end = first + blob.model.target_count;
    const Target* found = std::find_if(first, end, [&](const Target& t) { return options.target == t.name; });
    if (found == end) {
      throw InputError(path, 0, 0, "Found no target \"" + options.target + "\" in the blob; expected one of: " +
                                       names_of(blob.model) + ".");
    }
    std::copy(std::begin(found->flange_p_m), std::end(found->flange_p_m), blob.flange_T_target.position_m);
  }
  return blob;
}

void inform_all(const std::vector<std::string>& notes) {
  for (const std::string& note : notes) inform(note);
}

std::string status_word(Status status) {
  switch (status) {
    case Status::ok: return "ok";
    case Status::step_limited: return "step_limited";
    case Status::joint_limited: return "joint_limited";
    case Status::near_singular: return "near_singular";
    case Status::out_of_reach: return "out_of_reach";
    case Status::not_converged: return "not_converged";
    case Status::bad_input: return "bad_input";
    case Status::bad_environment: return "bad_environment";
    default: return "status_" + std::to_string(static_cast<std::int32_t>(status));
  }
}

}  // namespace mdhcal::offline
