// SPDX-License-Identifier: MIT
// Every kind of mistake on four arms, and sound jobs: what is named, what is not, what is accused wrongly.
//   mistakes_sweep SEEDS SOUND_JOBS [PART_OF_A_NAME]
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>

#include "offline/base/error.hpp"
#include "offline/identify/mistakes/diagnose.hpp"
#include "offline/simulate/family.hpp"
#include "tests/identify/wrong_jobs.hpp"

namespace {

using namespace mdhcal;
using namespace mdhcal::offline;

// The calibration of a job as it is; false if it was refused.
bool accepted(const Job& job, Calibration& out) {
  try {
    out = calibrate(job.robot, job.data, job.options);
    return out.converged;
  } catch (const std::runtime_error&) {
    return false;
  }
}

// Of this process: what else the machine does is not counted.
double seconds_used() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

}  // namespace

int main(int argc, char** argv) {
  const int seeds = argc > 1 ? std::atoi(argv[1]) : 3;
  const int sound = argc > 2 ? std::atoi(argv[2]) : 400;
  const char* part = argc > 3 ? argv[3] : "";
  int jobs = 0, named = 0, missed_and_wrong = 0;
  double longest = 0;
  for (const tests::MistakeMaker& maker : tests::mistake_makers()) {
    if (std::strstr(maker.name.c_str(), part) == nullptr) continue;
    int here = 0, good = 0;
    for (const std::string& family : family_names()) {
      for (int seed = 1; seed <= seeds; ++seed) {
        const auto number = static_cast<std::uint64_t>(seed);
        tests::WrongJob wrong = tests::sound_job(family, 24 + 4 * static_cast<std::size_t>(seed), number);
        Random random(number + 1000);
        if (!maker.make(wrong, random)) continue;
        Calibration c;
        const bool taken = accepted(wrong.job, c);
        const double error = taken ? tests::unseen_error_mm(c, wrong.unseen) : 0.0;
        const double start = seconds_used();
        const Diagnosis d = diagnose(wrong.job, taken ? std::optional<Residual>({c.scale_mm, c.train.after.mean}) : std::nullopt);
        const double time = seconds_used() - start;
        longest = std::max(longest, time);
        bool right = false;
        if (d.named() && d.findings.front().residual.scale_mm < maker.leaves_mm) {
          for (const std::string& kind : d.findings.front().kinds) {
            for (const std::string& expected : maker.kinds) right = right || kind == expected;
          }
        }
        ++here;
        if (right) ++good;
        const bool harmless = taken && error < 1.0;
        if (!right && !harmless) {
          std::printf("  %s, %s, seed %d: %s [%s, error %.2f mm, %.1f s]\n", maker.name.c_str(), family.c_str(), seed,
                      d.sentence.c_str(), taken ? "taken" : "refused", error, time);
        }
        if (!right && harmless) ++good;
        missed_and_wrong += taken && error > 1.0 && !d.named() ? 1 : 0;
      }
    }
    std::printf("%-40s %2d of %2d\n", maker.name.c_str(), good, here);
    std::fflush(stdout);
    jobs += here;
    named += good;
  }
  int accused = 0;
  for (int k = 1; k <= sound; ++k) {
    const tests::WrongJob job = tests::sound_job_of_any_kind(static_cast<std::uint64_t>(k));
    Calibration c;
    const bool taken = accepted(job.job, c);
    const Diagnosis d = diagnose(job.job, taken ? std::optional<Residual>({c.scale_mm, c.train.after.mean}) : std::nullopt);
    if (!d.named()) continue;
    ++accused;
    std::printf("  sound job %d accused: %s\n", k, d.sentence.c_str());
  }
  std::printf("named or harmless %d of %d; taken with more than 1 mm and not named %d; sound jobs accused %d of %d; longest search %.1f s\n",
              named, jobs, missed_and_wrong, accused, sound, longest);
  return 0;
}
