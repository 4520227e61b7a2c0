// SPDX-License-Identifier: MIT
#include "offline/identify/mistakes/screening.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "offline/identify/mistakes/judge.hpp"
#include "offline/robot/units.hpp"

namespace mdhcal::offline {

namespace {

struct LengthWord {
  const char* words;
  const char* suffix;  // of a column, where the format has one
  double metres;
};
constexpr LengthWord length_words[] = {
    {"metres", "_m", 1.0}, {"millimetres", "_mm", 1e-3}, {"inches", "", 0.0254}, {"micrometres", "", 1e-6}, {"centimetres", "", 1e-2}};
// Nominal geometry and few rows tell a ratio of lengths to a few per cent; units differ by at least 2.54.
constexpr double ratio_tolerance = 0.2;
// A map that leaves more than this of the spread says nothing of units and hands.
constexpr double telling_misfit = 0.3;

Estimate nominal_of(const Job& job) {
  Estimate out;
  out.geometry = job.robot.geometry;
  const std::size_t targets = std::max<std::size_t>(1, job.data.targets.size());
  for (std::size_t t = 0; t < targets; ++t) {
    Vector3 point = job.robot.tool_p_m.value_or(Vector3{});
    for (const TargetPoint& target : job.robot.targets) {
      if (t < job.data.targets.size() && target.name == job.data.targets[t]) point = target.flange_p_m;
    }
    out.flange_p_m.push_back(point);
  }
  return out;
}

double reach_m(const Robot& robot) {
  double sum = 0.0;
  for (std::int32_t i = 0; i < robot.geometry.joint_count; ++i) {
    sum += std::fabs(robot.geometry.link[i].a_m) + std::fabs(robot.geometry.link[i].d_m);
  }
  return sum;
}

bool better(const Candidate& a, const Candidate& b) {
  // Of two that leave about the same, the one that changes less.
  if (a.misfit < 0.98 * b.misfit || b.misfit < 0.98 * a.misfit) return a.misfit < b.misfit;
  if (a.changes() != b.changes()) return a.changes() < b.changes();
  return a.misfit < b.misfit;
}

void sort_best_first(std::vector<Candidate>& candidates) {
  // By the logarithm in steps, so that "about the same" orders strictly: within two per cent, where the closed fit's own
  // error lies. No misfit is zero.
  constexpr double about_the_same = 0.02;
  constexpr double least_positive = 1e-12;
  const auto step = [&](const Candidate& c) { return std::floor(std::log(std::max(c.misfit, least_positive)) / about_the_same); };
  std::stable_sort(candidates.begin(), candidates.end(), [&](const Candidate& a, const Candidate& b) {
    const double sa = step(a);
    const double sb = step(b);
    if (sa < sb || sb < sa) return sa < sb;
    return a.changes() < b.changes();
  });
}

}  // namespace

int Candidate::changes() const {
  int sum = 0;
  for (const Hypothesis* h : parts) sum += h->changes;
  return sum;
}

Screening::Screening(const Job& job) : job_(job), few_(thinned(job, screening_rows)) {
  for (Hypothesis& h : table_of_mistakes(job)) table_.push_back(std::move(h));
  discrete_ = table_.size();
  mirror_ = keep(mirrored_axis(1));
  const double read_m = job.robot.length_in_mm ? 1e-3 : 1.0;
  // An arm of less than a hand or of more than a house is not one: then its file is wrong, not the measurements.
  const double reach = reach_m(job.robot);
  const bool file_wrong = reach < 0.1 || reach > 20.0;
  for (const LengthWord& word : length_words) {
    const double factor = word.metres / read_m;
    if (std::fabs(factor - 1.0) < 1e-9) continue;
    // A suffix is believed; a unit that has none may stand under any.
    const bool believed = job.data.lengths_stated && word.suffix[0] != '\0';
    if (!believed && !file_wrong) {
      lengths_.emplace_back(1.0 / factor, keep(measured_length_unit(factor, word.words, word.suffix)));
    } else {
      const std::string unit(word.suffix[0] == '_' ? word.suffix + 1 : "");
      lengths_.emplace_back(factor, keep(table_length_unit(factor, word.words,
                                                           unit.empty() ? "convert the robot file's lengths to millimetres"
                                                                        : "set length_unit = \"" + unit + "\" in the robot file")));
    }
  }
}

const Hypothesis* Screening::keep(Hypothesis hypothesis) {
  table_.push_back(std::move(hypothesis));
  return &table_.back();
}

QuickFit Screening::fit_of(const std::vector<const Hypothesis*>& parts) {
  ++tried_;
  const bool rows = std::any_of(parts.begin(), parts.end(), [](const Hypothesis* h) { return h->rows; });
  Job changed = rows ? job_ : few_;
  if (!apply_all(parts, changed)) return {};
  if (rows) changed = thinned(changed, screening_rows);
  return quick_fit(nominal_of(changed), sightings_of(changed.data));
}

const Hypothesis* Screening::unit_for(double length_ratio, const std::vector<const Hypothesis*>& parts) {
  for (const Hypothesis* h : parts) {
    if (h->kind == MistakeKind::length_unit || h->kind == MistakeKind::table_length_unit) return nullptr;
  }
  for (const auto& [ratio, hypothesis] : lengths_) {
    if (std::fabs(std::log(length_ratio / ratio)) < ratio_tolerance) return hypothesis;
  }
  return nullptr;
}

Candidate Screening::evaluate(std::vector<const Hypothesis*> parts) {
  const QuickFit as_read = fit_of(parts);
  Candidate out{parts, as_read.misfit};
  if (!(as_read.affine_misfit < telling_misfit)) return out;
  const Hypothesis* unit = unit_for(as_read.length_ratio, parts);
  const bool hand = as_read.mirrored && std::find(parts.begin(), parts.end(), mirror_) == parts.end();
  if (unit == nullptr && !hand) return out;
  if (unit != nullptr) parts.push_back(unit);
  if (hand) parts.push_back(mirror_);
  const QuickFit changed = fit_of(parts);
  Candidate more{parts, changed.misfit};
  return better(more, out) && 2.0 * more.misfit < out.misfit ? more : out;
}

std::vector<Candidate> Screening::alone() {
  std::vector<Candidate> out;
  const Candidate nothing = evaluate({});
  if (!nothing.parts.empty()) out.push_back(nothing);
  for (std::size_t i = 0; i < discrete_; ++i) out.push_back(evaluate({&table_[i]}));
  sort_best_first(out);
  return out;
}

std::vector<Candidate> Screening::together(const std::vector<Candidate>& found,
                                           const std::function<void(std::size_t, std::size_t)>& progress) {
  // The best, and the best of each kind: what has to be right before anything fits may not help much by itself.
  std::vector<const Candidate*> beam;
  std::vector<MistakeKind> kinds;
  std::set<std::vector<const Hypothesis*>> sets;  // A with B is B with A
  const auto set_of = [](std::vector<const Hypothesis*> parts) {
    std::sort(parts.begin(), parts.end());
    return parts;
  };
  for (const Candidate& c : found) {
    const MistakeKind kind = c.parts.front()->kind;
    const bool seen = std::find(kinds.begin(), kinds.end(), kind) != kinds.end();
    if (beam.size() >= beam_width && seen) continue;
    if (!(c.misfit < HUGE_VAL) || !sets.insert(set_of(c.parts)).second) continue;
    if (!seen) kinds.push_back(kind);
    beam.push_back(&c);
  }
  std::vector<Candidate> out;
  std::size_t done = 0;
  for (const Candidate* c : beam) {
    if (progress) progress(done++, beam.size());
    for (std::size_t i = 0; i < discrete_; ++i) {
      const Hypothesis& h = table_[i];
      if (!h.deep) continue;
      if (!std::all_of(c->parts.begin(), c->parts.end(), [&](const Hypothesis* p) { return composable(*p, h); })) continue;
      std::vector<const Hypothesis*> parts = c->parts;
      parts.push_back(&h);
      if (!sets.insert(set_of(parts)).second) continue;
      out.push_back(evaluate(std::move(parts)));
    }
  }
  sort_best_first(out);
  return out;
}

}  // namespace mdhcal::offline
