// SPDX-License-Identifier: MIT
// What a verdict is worth, over simulated jobs: verdict_sweep [COUNT [FIRST_SEED]]
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/identify/verdict_jobs.hpp"

namespace {

using namespace mdhcal::tests;

struct Tally {
  std::size_t jobs = 0, held = 0, below_half = 0, zero = 0, usable = 0;
  double said = 0, truth = 0, noise_free = 0, log_ratio = 0, worst = HUGE_VAL;

  void add(const VerdictOutcome& o) {
    ++jobs;
    held += o.low <= o.truth && o.truth <= o.high ? 1U : 0U;
    below_half += o.mean < 0.5 * o.truth ? 1U : 0U;
    zero += o.verdict.find(" 0 mm") != std::string::npos || !(o.mean > 0) ? 1U : 0U;
    usable += o.usable ? 1U : 0U;
    said += o.mean;
    truth += o.truth;
    noise_free += o.noise_free;
    log_ratio += std::log(o.mean / o.truth);
    worst = std::min(worst, o.mean / o.truth);
  }
  void print(const char* what) const {
    if (jobs == 0) return;
    const auto n = static_cast<double>(jobs);
    std::printf("%-34s %4zu jobs: said / true %.3f (mean of logarithms %.3f, least %.2f), true within bounds %.1f %%, below half of "
                "the truth %zu, \"0 mm\" %zu, usable %zu, true mean %.3f mm (without noise %.3f)\n",
                what, jobs, said / truth, std::exp(log_ratio / n), worst, 100.0 * static_cast<double>(held) / n, below_half, zero,
                usable, truth / n, noise_free / n);
  }
};

}  // namespace

int main(int argc, char** argv) {
  const std::uint64_t count = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 600;
  const std::uint64_t first = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1;
  for (const bool held_out : {true, false}) {
    Tally all, gross, clean, beyond;
    Tally by_size[4];
    std::size_t refused = 0;
    for (std::uint64_t seed = first; seed < first + count; ++seed) {
      const VerdictJob job = verdict_job(seed);
      VerdictOutcome outcome;
      try {
        outcome = outcome_of(job, seed, held_out);
      } catch (const std::runtime_error& e) {
        ++refused;
        std::printf("seed %llu refused: %s\n", static_cast<unsigned long long>(seed), e.what());
        continue;
      }
      if (outcome.mean < 0.5 * outcome.truth) {
        std::printf("seed %llu %s, %zu poses%s%s%s: said %.4f, true %.4f mm\n", static_cast<unsigned long long>(seed),
                    job.family.c_str(), job.poses, job.sag ? ", sag" : "", job.joint_function ? ", joint function" : "",
                    job.gross ? ", gross" : "", outcome.mean, outcome.truth);
      }
      if (held_out || job.poses >= 12) all.add(outcome);
      by_size[job.poses < 12 ? 0 : job.poses < 20 ? 1 : job.poses < 40 ? 2 : 3].add(outcome);
      (job.gross ? gross : job.sag || job.joint_function ? beyond : clean).add(outcome);
    }
    std::printf("%s, %zu refused\n", held_out ? "15 held-out rows" : "cross-validated", refused);
    all.print(held_out ? "all" : "from 12 poses on");
    by_size[0].print("6 to 11 poses");
    by_size[1].print("12 to 19 poses");
    by_size[2].print("20 to 39 poses");
    by_size[3].print("40 to 80 poses");
    clean.print("geometry alone");
    beyond.print("sag or joint function");
    gross.print("gross rows");
  }
  return 0;
}
