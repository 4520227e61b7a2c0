// SPDX-License-Identifier: MIT
#include "offline/identify/mistakes/diagnose.hpp"

#include <algorithm>
#include <cmath>

#include "offline/base/error.hpp"
#include "offline/base/sentences.hpp"
#include "offline/identify/mistakes/continuous.hpp"
#include "offline/identify/mistakes/judge.hpp"
#include "offline/identify/mistakes/screening.hpp"
#include "offline/identify/mistakes/series.hpp"
#include "offline/identify/rotation_check.hpp"
#include "offline/identify/verdict.hpp"

namespace mdhcal::offline {

namespace {

// What the models of sag and joint functions are worth on real arms is a half to a third (METHOD.md 9.3): a mistake has
// to explain more than they could.
constexpr double least_gain = 3.0;
constexpr std::size_t most_judged = 10;     // of each depth of the screening
constexpr std::size_t most_confirmed = 4;   // a calibration each
constexpr std::size_t most_together = 3;
constexpr std::size_t steps = 8;

double reach_mm(const Robot& robot) {
  double sum = 0.0;
  for (std::int32_t i = 0; i < robot.geometry.joint_count; ++i) {
    sum += std::fabs(robot.geometry.link[i].a_m) + std::fabs(robot.geometry.link[i].d_m);
  }
  return 1e3 * sum;
}

struct Explanation {
  std::vector<const Hypothesis*> parts;
  Judgement judged;

  int changes() const {
    int sum = 0;
    for (const Hypothesis* h : parts) sum += h->changes;
    return sum;
  }
  // One mistake more has to explain as much more as a mistake must at all.
  double key() const {
    return judged.scale_mm * std::pow(least_gain, static_cast<double>(parts.size()) - 1.0) * (1.0 + 0.01 * changes());
  }
};

class Search {
 public:
  Search(const Job& job, const std::function<void(std::size_t, std::size_t)>& progress)
      : job_(job), progress_(progress), screening_(job), given_(judge(job)) {}

  Diagnosis run(const std::optional<Residual>& as_given);
  Diagnosis run_frames(const std::optional<Residual>& as_given);

 private:
  void step() {
    if (progress_) progress_(step_++, steps);
  }

  bool changed(const std::vector<const Hypothesis*>& parts, Job& out) const {
    out = job_;
    return apply_all(parts, out);
  }

  void add(std::vector<const Hypothesis*> parts) {
    if (parts.size() > most_together + (job_.options.fit_base && job_.options.fit_tool ? 0U : 1U)) return;
    Job other;
    if (!changed(parts, other)) return;
    ++judged_;
    Explanation alone{parts, judge(other)};
    // The screening leaves base and tool free; where they are given, they may be part of what is wrong.
    if (free_frames_ != nullptr && std::find(parts.begin(), parts.end(), free_frames_) == parts.end()) {
      Explanation freed{parts, {}};
      freed.parts.push_back(free_frames_);
      if (free_frames_->apply(other)) freed.judged = judge(other);
      if (freed.key() < alone.key()) alone = freed;
    }
    if (alone.judged.scale_mm < HUGE_VAL) pool_.push_back(std::move(alone));
  }

  void sort() {
    std::stable_sort(pool_.begin(), pool_.end(), [](const Explanation& a, const Explanation& b) { return a.key() < b.key(); });
  }

  std::size_t trials() const { return screening_.tried() + judged_; }

  // Residuals over spread: a file in metres read as millimetres must not win by being small.
  bool significant(const Explanation& e) const {
    const double freedom = std::min(given_.freedom, e.judged.freedom);
    const double before = given_.scale_mm < HUGE_VAL ? given_.scale_mm / given_.spread_mm : 1.0;
    const double after = e.judged.scale_mm / e.judged.spread_mm;
    if (least_gain * after < before && explains_more(before, after, freedom, freedom, trials())) return true;
    return e.parts.size() == 1 && e.parts.front()->place > 0 && few_rows(e);
  }

  // What goes wrong from some row on leaves the median as it is where few rows are behind it: then those rows speak for
  // themselves.
  bool few_rows(const Explanation& e) const {
    Job other;
    if (!(given_.scale_mm < HUGE_VAL) || !changed(e.parts, other)) return false;
    // All the other rows fit as given, and with no stranger geometry.
    if (given_.residual_mm > least_gain * e.judged.residual_mm || e.judged.scale_mm > 1.1 * given_.scale_mm) return false;
    const std::size_t place = e.parts.front()->place;
    const std::size_t rows = std::min(job_.data.rows.size(), other.data.rows.size());
    const bool late = 2 * place > rows;
    const std::size_t begin = late ? place : 0;
    const std::size_t end = late ? rows : place;
    const double before = median_error_mm(given_.fit.estimate, job_.data, begin, end);
    const double after = std::max(e.judged.residual_mm, median_error_mm(e.judged.fit.estimate, other.data, begin, end));
    // Of one place in the series; what is left after it is known from all the rows.
    const double freedom = 3.0 * static_cast<double>(end - begin);
    return least_gain * after < before && explains_more(before, after, freedom, e.judged.freedom, rows);
  }

  // Each part has to earn its place: without it, a threefold more is left.
  bool idle_part(const Explanation& e) const {
    return std::any_of(pool_.begin(), pool_.end(), [&](const Explanation& sub) {
      return sub.parts.size() < e.parts.size() &&
             std::all_of(sub.parts.begin(), sub.parts.end(),
                         [&](const Hypothesis* h) { return std::find(e.parts.begin(), e.parts.end(), h) != e.parts.end(); }) &&
             sub.judged.scale_mm < least_gain * e.judged.scale_mm;
    });
  }

  // Nothing of centimetres is left: searching further finds nothing larger.
  bool explained() {
    sort();
    return !pool_.empty() && significant(pool_.front()) && pool_.front().judged.scale_mm < limit_mm();
  }

  void frames();
  void screened(const std::vector<Candidate>& candidates);
  void numbers(const std::vector<const Hypothesis*>& parts, const Job& job, const Judgement& at);
  void series(const std::vector<const Hypothesis*>& parts, const Job& job, const Judgement& at);
  void deepen();
  void confirm(Diagnosis& out);

  // Half of what a calibration may leave unexplained (two millimetres or 0.2 % of the reach): a cure leaves less.
  double limit_mm() const { return std::max(1.0, 1e-3 * reach_mm(job_.robot)); }

  // The calibration with the cure leaves no more than the one as given, over the points' spreads. (That may have reached
  // the same with a geometry out of all bounds, or by calling many rows gross: the judgement saw that.)
  bool no_worse(const Finding& f, const Judgement& cured, const Residual& as_given) const {
    if (!(given_.spread_mm < HUGE_VAL)) return true;
    return f.residual.scale_mm / cured.spread_mm < 1.2 * as_given.scale_mm / given_.spread_mm;
  }

  const Job& job_;
  const std::function<void(std::size_t, std::size_t)>& progress_;
  Screening screening_;
  Judgement given_;
  const Hypothesis* free_frames_ = nullptr;
  std::vector<Explanation> pool_;
  std::size_t judged_ = 0;
  std::size_t step_ = 0;
};

void Search::frames() {
  if (job_.options.fit_base && job_.options.fit_tool) return;
  const auto freed = [&](bool base, bool tool) {
    Hypothesis h;
    h.kind = MistakeKind::frame;
    h.what = base && tool ? "base and tool fitted" : base ? "the base fitted" : "the tool fitted";
    h.cure = std::string("use ") + (base ? "--base fit" : "") + (base && tool ? " " : "") + (tool ? "--tool fit" : "");
    h.changes = base && tool ? 2 : 1;
    h.apply = [base, tool](Job& j) {
      j.options.fit_base = j.options.fit_base || base;
      j.options.fit_tool = j.options.fit_tool || tool;
      return true;
    };
    return screening_.keep(h);
  };
  const bool both = !job_.options.fit_base && !job_.options.fit_tool;
  const Hypothesis* whole = freed(!job_.options.fit_base, !job_.options.fit_tool);
  if (both) {
    add({freed(true, false)});
    add({freed(false, true)});
  }
  add({whole});
  free_frames_ = whole;
}

void Search::screened(const std::vector<Candidate>& candidates) {
  const double nothing = screening_.evaluate({}).parts.empty() ? screening_.evaluate({}).misfit : HUGE_VAL;
  for (std::size_t k = 0; k < candidates.size() && k < most_judged; ++k) {
    if (candidates[k].misfit < nothing) add(candidates[k].parts);
  }
}

void Search::numbers(const std::vector<const Hypothesis*>& parts, const Job& job, const Judgement& at) {
  for (Hypothesis& h : continuous_mistakes(job, at)) {
    std::vector<const Hypothesis*> more = parts;
    more.push_back(screening_.keep(std::move(h)));
    add(more);
  }
}

void Search::series(const std::vector<const Hypothesis*>& parts, const Job& job, const Judgement& at) {
  const auto each = [&](std::vector<Hypothesis> found) {
    for (Hypothesis& h : found) {
      std::vector<const Hypothesis*> more = parts;
      more.push_back(screening_.keep(std::move(h)));
      add(more);
    }
  };
  each(moved_tracker(job, at));
  each(slipped_rows(job));
  each(repeated_points(job));
  each(stuck_joints(job));
}

// The best so far, each with a number or a move besides.
void Search::deepen() {
  sort();
  std::vector<Explanation> best(pool_.begin(), pool_.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(3, pool_.size())));
  for (const Explanation& e : best) {
    Job other;
    if (e.parts.size() >= most_together || !changed(e.parts, other)) continue;
    numbers(e.parts, other, e.judged);
    series(e.parts, other, e.judged);
  }
}

void Search::confirm(Diagnosis& out) {
  sort();
  for (const Explanation& e : pool_) {
    if (out.findings.size() >= most_confirmed) break;
    if (!significant(e) || idle_part(e)) continue;
    Finding finding;
    std::vector<std::string> what;
    for (const Hypothesis* h : e.parts) {
      finding.kinds.push_back(word(h->kind));
      what.push_back(h->what);
      finding.cure += (finding.cure.empty() ? "" : "; ") + h->cure;
    }
    finding.what = joined(what);
    finding.changes = e.changes();
    const bool said = std::any_of(out.findings.begin(), out.findings.end(), [&](const Finding& f) { return f.what == finding.what; });
    Job other;
    if (said || !changed(e.parts, other)) continue;
    try {
      other.options.cross_validate = false;  // the residual is what is asked for
      const Calibration c = calibrate(other.robot, other.data, other.options);
      finding.residual = {c.scale_mm, c.train.after.mean};
      finding.offered = c.converged && c.scale_mm < limit_mm() && no_worse(finding, e.judged, out.as_given);
    } catch (const std::runtime_error&) {
      continue;  // the calibration itself finds that this cannot be
    }
    out.findings.push_back(finding);
  }
  std::stable_sort(out.findings.begin(), out.findings.end(), [](const Finding& a, const Finding& b) {
    if (a.offered != b.offered) return a.offered;
    // What leaves the same is ordered by how little it changes.
    const double low = std::min(a.residual.scale_mm, b.residual.scale_mm);
    const double high = std::max(a.residual.scale_mm, b.residual.scale_mm);
    if (high < 1.05 * low) return a.changes < b.changes;
    return a.residual.scale_mm < b.residual.scale_mm;
  });
}

std::string sentence_of(const Diagnosis& d) {
  if (!d.named()) {
    return "None of " + std::to_string(d.tried) +
           " hypotheses on units, signs, zeros, order and coupling of joints, conventions, hands and frames explains the "
           "measurements.";
  }
  const Finding& best = d.findings.front();
  // Where the median hides it, the mean of all rows shows it; where both are the same, the geometry does.
  const bool by_scale = best.residual.scale_mm * least_gain < d.as_given.scale_mm;
  const bool by_mean = !by_scale && best.residual.mean_mm * least_gain < d.as_given.mean_mm;
  const std::string with = "With " + best.what + " the ";
  const std::string cure = ": " + best.cure + ".";
  if (by_mean) {
    return with + "mean error of all rows is " + number(best.residual.mean_mm) + " mm (as given: " + number(d.as_given.mean_mm) +
           " mm)" + cure;
  }
  return with + "residual is " + number(best.residual.scale_mm) + " mm (as given: " + number(d.as_given.scale_mm) + " mm" +
         (by_scale ? ")" : ", by a geometry far from nominal)") + cure;
}

Diagnosis Search::run(const std::optional<Residual>& as_given) {
  Diagnosis out;
  out.as_given = as_given.value_or(Residual{given_.scale_mm, given_.scale_mm});
  frames();
  step();
  std::vector<Candidate> found = screening_.alone();
  screened(found);
  step();
  numbers({}, job_, given_);
  step();
  series({}, job_, given_);
  step();
  if (!explained()) deepen();
  step();
  for (std::size_t depth = 2; depth <= most_together && !explained(); ++depth) {
    found = screening_.together(found, {});
    screened(found);
    if (!explained()) deepen();
    step();
  }
  confirm(out);
  out.tried = trials();
  out.sentence = sentence_of(out);
  return out;
}

Diagnosis Search::run_frames(const std::optional<Residual>& as_given) {
  Diagnosis out;
  out.as_given = as_given.value_or(Residual{given_.scale_mm, given_.scale_mm});
  frames();
  for (Hypothesis& h : moved_tracker(job_, given_)) add({screening_.keep(std::move(h))});
  confirm(out);
  out.tried = trials();
  out.sentence = sentence_of(out);
  return out;
}

}  // namespace

Diagnosis diagnose(const Job& job, const std::optional<Residual>& as_given,
                   const std::function<void(std::size_t, std::size_t)>& progress) {
  return Search(job, progress).run(as_given);
}

std::optional<Diagnosis> explain_by_mistakes(const Job& job, bool always, Calibration& calibration,
                                             const std::function<void(std::size_t, std::size_t)>& progress) {
  const bool usable = calibration.usable();
  const bool whole = always || !usable;
  // That the rotations are misread explains what is wrong; the positions are good.
  if (!always && !calibration.contradiction.empty()) return std::nullopt;
  const double noise_mm = states_sigma(calibration.training) ? calibration.residual_unit_mm : calibration.noise_mm;
  if (!whole && calibration.scale_mm < 2.0 * noise_mm) return std::nullopt;
  const Residual as_given{calibration.scale_mm, calibration.train.after.mean};
  Job searched = job;
  if (!calibration.contradiction.empty()) leave_out_rotations(searched.data);
  const Diagnosis out = whole ? diagnose(searched, as_given, progress) : Search(searched, progress).run_frames(as_given);
  if (out.named()) {
    calibration.reasons.insert(calibration.reasons.begin(), out.sentence);
  } else if (whole) {
    calibration.notes.push_back(out.sentence);
  }
  if (usable && !calibration.usable()) calibration.accepted = job.options.accept;
  calibration.verdict = verdict_of(calibration);
  return out;
}

}  // namespace mdhcal::offline
