// SPDX-License-Identifier: MIT
#include "offline/identify/notes.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "offline/base/sentences.hpp"
#include "offline/identify/verdict.hpp"

namespace mdhcal::offline {

namespace {

bool states_another_nominal(const Robot& robot) {
  for (std::int32_t i = 0; i < robot.geometry.joint_count; ++i) {
    if (std::memcmp(&robot.geometry.link[i], &robot.nominal[static_cast<std::size_t>(i)], sizeof(Link)) != 0) return true;
  }
  return false;
}

bool lost(const WeakDirection& w) { return !(w.relative_singular_value > 0.0); }

// Without its end.
std::string sentence_of(const WeakDirection& w) {
  const bool alone = w.members.size() == 1;
  if (lost(w)) return joined(w.members) + (alone ? " is not seen" : " are confounded");
  return joined(w.members) + (alone ? " is seen only weakly" : " are nearly confounded") + " (" +
         number(w.relative_singular_value) + " of the strongest direction)";
}

// How many combinations are lost or weak, the worst of each, and what would tell those.
std::string note_of(const std::vector<WeakDirection>& weak) {
  const auto first_weak = std::find_if_not(weak.begin(), weak.end(), lost);
  const auto lost_count = static_cast<std::size_t>(first_weak - weak.begin());
  const std::size_t weak_count = weak.size() - lost_count;
  std::string out = "Combinations of parameters that these poses tell badly: " + std::to_string(lost_count) + " lost, " +
                    std::to_string(weak_count) + " weak (below 0.01 of the strongest).";
  if (lost_count > 0) out += " Lost first: " + sentence_of(weak.front()) + ". " + weak.front().advice;
  if (weak_count > 0) {
    WeakDirection worst = *first_weak;
    constexpr std::size_t most = 4;
    const std::size_t more = worst.members.size() > most ? worst.members.size() - most : 0;
    if (more > 0) {
      worst.members.resize(most - 1);
      worst.members.push_back(std::to_string(more + 1) + " others");
    }
    out += " Weakest: " + sentence_of(worst) + ". " + worst.advice;
  }
  return out + (weak.size() > 1 ? " All of them: --verbose, or weak_directions in result.json." : "");
}

}  // namespace

void add_standing_notes(const Dataset& data, Calibration& c) {
  std::size_t scalars = 0;
  for (std::size_t row : c.training_rows) scalars += residual_count(data.rows[row].kind);
  const std::size_t unknowns = c.layout.frame_columns() + c.layout.geometry.size();
  if (scalars < unknowns) {
    c.notes.push_back("There are fewer scalar measurements (" + std::to_string(scalars) + ") than unknowns (" +
                      std::to_string(unknowns) + "): the penalty decides what the measurements leave open.");
  }
  if (states_another_nominal(c.robot)) {
    c.notes.push_back("The robot file states a geometry that was corrected before: deviations and their penalty count "
                      "from its geometry, and \"nominal\" in the figures means it. The maker's nominal links are kept.");
  }
  const bool only_lengths = std::all_of(c.training_rows.begin(), c.training_rows.end(), [&](std::size_t row) {
    return data.rows[row].kind == MeasurementKind::distance;
  });
  if (only_lengths && c.identifiability.frame_rank < c.identifiability.frame_unknowns) {
    c.notes.push_back("Lengths tell " + std::to_string(c.identifiability.frame_rank) + " of the " +
                      std::to_string(c.identifiability.frame_unknowns) +
                      " unknowns of base frame and targets: the rest keeps its starting value. Positions in the tracker's frame are "
                      "not to be read off this result; lengths and the robot's own frame are.");
  }
  std::vector<std::string> lost;
  std::vector<std::string> far;
  for (const EstimatedParameter& p : c.parameters) {
    if (!p.identifiable) lost.push_back(name(p.id));
    if (std::fabs(p.deviation) > 15.0 * p.prior) far.push_back(name(p.id));
  }
  if (!lost.empty()) {
    c.notes.push_back(joined(lost) + (lost.size() == 1 ? " is" : " are") +
                      " not identifiable from these poses (alone or at all).");
  }
  for (const WeakDirection& w : c.identifiability.weak) c.details.push_back(sentence_of(w) + ". " + w.advice);
  if (!c.identifiability.weak.empty()) c.notes.push_back(note_of(c.identifiability.weak));
  if (!far.empty()) {
    c.notes.push_back(joined(far) + (far.size() == 1 ? " deviates" : " deviate") +
                      " by more than 15 prior standard deviations from nominal: either the prior is too narrow for "
                      "this robot, or these parameters are told so badly that they must not be read one by one.");
  }
  const std::vector<std::string> findings = findings_of(c);
  c.notes.insert(c.notes.end(), findings.begin(), findings.end());
  c.notes.push_back(c.model.chosen == 0
      ? "Compliance, backlash and thermal drift are in no parameter: they stay in the residual, and the intervals cover "
        "the geometry only."
      : "Backlash and thermal drift are in no parameter: they stay in the residual. Outside the readings, the workspace and the "
        "lean that were measured nothing vouches for joint functions and sag.");
}

}  // namespace mdhcal::offline
