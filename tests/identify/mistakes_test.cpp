// SPDX-License-Identifier: MIT
// The search over what people get wrong: every kind of mistake is named with the cure that repairs it, and sound jobs are
// not accused. The long form is mistakes_sweep.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "offline/identify/mistakes/diagnose.hpp"
#include "offline/identify/mistakes/hypothesis.hpp"
#include "offline/identify/mistakes/judge.hpp"
#include "offline/identify/mistakes/quick_fit.hpp"
#include "offline/robot/vectors.hpp"
#include "offline/simulate/family.hpp"
#include "tests/identify/wrong_jobs.hpp"

namespace mdhcal::tests {

using namespace offline;

namespace {

bool about(const Finding& finding, const std::vector<std::string>& kinds) {
  return std::any_of(finding.kinds.begin(), finding.kinds.end(), [&](const std::string& kind) {
    return std::find(kinds.begin(), kinds.end(), kind) != kinds.end();
  });
}

Diagnosis diagnosis_of(const Job& job) { return diagnose(job, std::nullopt); }

Estimate nominal_of(const Job& job) {
  Estimate out;
  out.geometry = job.robot.geometry;
  out.flange_p_m.push_back(*job.robot.tool_p_m);
  return out;
}

}  // namespace

// The closed fit leaves what the deviations of half a millimetre leave, and the mirrored map says so of itself.
TEST(QuickFit, TellsLengthsAndHandsOfTheMeasuredFrame) {
  for (const std::string& family : family_names()) {
    SCOPED_TRACE(family);
    WrongJob sound = sound_job(family, 30, 3);
    const QuickFit plain = quick_fit(nominal_of(sound.job), sightings_of(sound.job.data));
    EXPECT_LT(plain.misfit, 0.02);
    EXPECT_FALSE(plain.mirrored);
    EXPECT_NEAR(plain.length_ratio, 1.0, 0.05);
    for (Measurement& m : sound.job.data.rows) {
      for (double& c : m.position_m) c /= 25.4;
      m.position_m[2] = -m.position_m[2];
    }
    const QuickFit small = quick_fit(nominal_of(sound.job), sightings_of(sound.job.data));
    EXPECT_TRUE(small.mirrored);
    EXPECT_NEAR(small.length_ratio, 1.0 / 25.4, 0.05 / 25.4);
    EXPECT_GT(small.misfit, 0.5);  // however small the measured points are
  }
}

TEST(Mistakes, EachKindIsNamedWithTheCureThatRepairsIt) {
  std::size_t next = 0;
  std::size_t named = 0;
  std::size_t made = 0;
  for (const MistakeMaker& maker : mistake_makers()) {
    const std::string family = family_names()[next++ % family_names().size()];
    SCOPED_TRACE(maker.name + " on " + family);
    WrongJob wrong = sound_job(family, 28, next);
    Random random(1000 + next);
    if (!maker.make(wrong, random)) continue;
    ++made;
    const Diagnosis d = diagnosis_of(wrong.job);
    EXPECT_EQ(d.named(), !d.findings.empty() && d.findings.front().offered);
    if (!d.named() || d.findings.front().residual.scale_mm > maker.leaves_mm || !about(d.findings.front(), maker.kinds)) {
      std::printf("not named: %s on %s: %s\n", maker.name.c_str(), family.c_str(), d.sentence.c_str());
      continue;
    }
    ++named;
    EXPECT_NE(d.sentence.find(d.findings.front().cure), std::string::npos);
  }
  EXPECT_GE(made, 40U);
  EXPECT_GE(10 * named, 9 * made) << named << " of " << made;
}

TEST(Mistakes, SoundJobsAreNotAccused) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(seed);
    const WrongJob job = sound_job_of_any_kind(seed);
    const Diagnosis d = diagnosis_of(job.job);
    EXPECT_FALSE(d.named()) << d.sentence;
  }
}

// Readings in radians under a header that says degrees: nothing is offered that contradicts the header.
TEST(Mistakes, AStatedUnitIsBelieved) {
  WrongJob wrong = sound_job("three-parallel", 20, 5);
  wrong.job.data.angles_stated = wrong.job.data.lengths_stated = true;
  for (const Hypothesis& h : table_of_mistakes(wrong.job)) {
    EXPECT_NE(h.kind, MistakeKind::angle_unit);
    EXPECT_NE(h.kind, MistakeKind::length_unit);
    EXPECT_NE(h.kind, MistakeKind::reading_unit);
  }
}

TEST(Mistakes, AMoveOfTheLastRowsIsNamedWithPlaceAndSize) {
  WrongJob wrong = sound_job("spherical-wrist", 24, 7);
  std::vector<Measurement>& rows = wrong.job.data.rows;
  for (std::size_t i = 20; i < rows.size(); ++i) rows[i].position_m[0] += 3e-3;
  const Diagnosis d = diagnosis_of(wrong.job);
  ASSERT_TRUE(d.named()) << d.sentence;
  EXPECT_EQ(d.findings.front().kinds.front(), "moved tracker");
  EXPECT_NE(d.sentence.find("before row " + rows[20].id), std::string::npos) << d.sentence;
}

// Two scales that chance explains are not told apart, a threefold one of many residuals is.
TEST(Judgement, AsksMoreOfFewResiduals) {
  EXPECT_FALSE(explains_more(3.0, 1.0, 9.0, 9.0, 1000));
  EXPECT_TRUE(explains_more(3.0, 1.0, 150.0, 150.0, 1000));
  EXPECT_FALSE(explains_more(1.0, 1.0, 1e4, 1e4, 1));
  EXPECT_FALSE(explains_more(1.0, 2.0, 1e4, 1e4, 1));
  EXPECT_TRUE(explains_more(5000.0, 1.0, 9.0, 9.0, 1000));
}

}  // namespace mdhcal::tests
