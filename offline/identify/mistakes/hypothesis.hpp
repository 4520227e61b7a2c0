// SPDX-License-Identifier: MIT
// The table of what people get wrong: each entry a function from a job to the job without that mistake.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "offline/identify/mistakes/job.hpp"

namespace mdhcal::offline {

/// What a hypothesis is about. Two of one kind are only put together where that says something new (composable()).
enum class MistakeKind : std::int32_t {
  angle_unit, length_unit, reading_unit, table_angle_unit, table_length_unit, convention, order, sign, zero, ratio,
  coupling, length_sign, twist_sign, mirror, timing, frame, moved, drift, repeated, stuck, rotation
};

const char* word(MistakeKind kind);  ///< as in result.json

struct Hypothesis {
  MistakeKind kind = MistakeKind::sign;
  std::string what;   ///< goes behind "with": "q4_deg and q6_deg reversed"
  std::string cure;   ///< what to do about it: "set sign = -1 in links 4 and 6"
  int changes = 1;    ///< how many facts it changes: of two that explain the same, the smaller is offered
  bool first = false; ///< changes the robot file's reading: applied before what changes single joints
  bool rows = false;  ///< looks at neighbouring rows: applied before rows are thinned
  std::size_t place = 0; ///< the first row that it changes, where it changes a series from there on; else 0
  bool deep = true;   ///< tried together with others
  /// The job without the mistake; false where the change leaves the valid range.
  std::function<bool(Job&)> apply;
};

/// Whether the two say something together that neither says alone.
bool composable(const Hypothesis& a, const Hypothesis& b);

/// Every discrete hypothesis about `job`, none of which contradicts a unit that its files state.
std::vector<Hypothesis> table_of_mistakes(const Job& job);

/// Applies hypotheses in the order in which the data flows; false if one of them cannot be.
bool apply_all(const std::vector<const Hypothesis*>& hypotheses, Job& job);

/// "q4_deg": how the reading of a joint (from 0) is called in the file.
std::string reading_name(const Dataset& data, std::size_t joint);
/// "link 4" or "links 4 and 6", from joints counted from 0.
std::string links_in_words(const std::vector<std::size_t>& joints);

/// Positions and distances times `factor`; `words` names the unit that they are in.
Hypothesis measured_length_unit(double factor, const std::string& words, const std::string& suffix);
/// Lengths of the robot file times `factor`.
Hypothesis table_length_unit(double factor, const std::string& words, const std::string& cure);
/// One axis of the measured frame counted the other way.
Hypothesis mirrored_axis(std::size_t axis);
/// The joints of the set count the other way round.
Hypothesis reversed(const Job& job, const std::vector<std::size_t>& joints);
/// `turn_rad` added to the zero of each joint.
Hypothesis zero_moved(const Job& job, const std::vector<std::pair<std::size_t, double>>& turns_rad);
/// `ratio` times the reading of joint `by` added to joint `of`.
Hypothesis coupled(const std::vector<std::array<std::size_t, 2>>& of_by, const std::vector<double>& ratios);
/// The reading of a joint times `factor`.
Hypothesis geared(const Job& job, std::size_t joint, double factor);
/// Column `from[j]` of the readings belongs to joint j.
Hypothesis reordered(const Job& job, const std::vector<std::size_t>& from);
/// The readings lie `shift` rows behind (1) or before (-1) the points, from row `from` on.
Hypothesis shifted_rows(const Job& job, int shift, std::size_t from);

}  // namespace mdhcal::offline
