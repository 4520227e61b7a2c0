// SPDX-License-Identifier: MIT
// The search for mistakes that change the fit by centimetres: every discrete hypothesis, then the best of them together
// with others.
#pragma once

#include <deque>
#include <functional>

#include "offline/identify/mistakes/hypothesis.hpp"
#include "offline/identify/mistakes/quick_fit.hpp"

namespace mdhcal::offline {

/// Hypotheses put together, and what they leave.
struct Candidate {
  std::vector<const Hypothesis*> parts;
  double misfit = HUGE_VAL;  ///< QuickFit::misfit

  int changes() const;
};

/// At most this many rows are screened by; they tell centimetres of a geometry's millimetres.
inline constexpr std::size_t screening_rows = 40;
/// So many of one depth are put together with others.
inline constexpr std::size_t beam_width = 12;

class Screening {
 public:
  explicit Screening(const Job& job);

  /// Every hypothesis alone, best first.
  std::vector<Candidate> alone();
  /// The best of `found` each together with every other hypothesis, best first.
  std::vector<Candidate> together(const std::vector<Candidate>& found, const std::function<void(std::size_t, std::size_t)>& progress);
  /// Keeps a hypothesis that was made elsewhere.
  const Hypothesis* keep(Hypothesis hypothesis);
  /// What one candidate leaves; its measured unit of length and hand are chosen here.
  Candidate evaluate(std::vector<const Hypothesis*> parts);

  std::size_t tried() const { return tried_; }

 private:
  QuickFit fit_of(const std::vector<const Hypothesis*>& parts);
  const Hypothesis* unit_for(double length_ratio, const std::vector<const Hypothesis*>& parts);

  const Job& job_;
  Job few_;
  std::deque<Hypothesis> table_;  // a deque: what points into it stays
  std::size_t discrete_ = 0;      // hypotheses of the table proper
  std::size_t tried_ = 0;
  const Hypothesis* mirror_ = nullptr;
  std::vector<std::pair<double, const Hypothesis*>> lengths_;  // ratio that each repairs
};

}  // namespace mdhcal::offline
