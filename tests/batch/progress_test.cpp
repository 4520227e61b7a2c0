// SPDX-License-Identifier: MIT
#include "offline/cli/progress.hpp"

#include <gtest/gtest.h>

namespace {

using mdhcal::offline::Progress;
using mdhcal::offline::progress_line;

TEST(ProgressLine, SaysHowFarAndHowLong) {
  EXPECT_EQ(progress_line("compare", 0, 60, 2), "compare 0/60");
  EXPECT_EQ(progress_line("compare", 12, 60, 1), "compare 12/60 (20 %), 4 s left");
  EXPECT_EQ(progress_line("compare", 1, 61, 3), "compare 1/61 (1 %), 3 min left");
  EXPECT_EQ(progress_line("compare", 1, 7201, 1), "compare 1/7201 (0 %), 2 h left");
  EXPECT_EQ(progress_line("compare", 60, 60, 5), "compare 60/60 (100 %)");
  EXPECT_EQ(progress_line("compare", 0, 0, 5), "compare 0/0");
}

// The tests' stderr is a pipe or a file as a rule; under a terminal the one-second rule keeps this silent too.
TEST(Progress, IsSilentWhereItIsNotWanted) {
  testing::internal::CaptureStderr();
  {
    Progress progress("simulate");
    progress.callback()(1, 2);
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace
