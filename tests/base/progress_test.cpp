// SPDX-License-Identifier: MIT
#include "offline/base/progress.hpp"

#include <gtest/gtest.h>
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

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

// What a child whose stderr is a new terminal writes there in a second and a half.
std::string on_a_terminal(bool enabled) {
  int screen = -1;
  const pid_t child = forkpty(&screen, nullptr, nullptr, nullptr);
  if (child == 0) {
    {
      Progress progress("simulate", enabled);
      for (std::size_t k = 0; k < 14; ++k) {
        progress.update(k, 28);
        usleep(100000);
      }
    }
    _exit(0);
  }
  std::string shown;
  char buffer[256];
  for (ssize_t count = 0; (count = ::read(screen, buffer, sizeof buffer)) > 0;) shown.append(buffer, static_cast<std::size_t>(count));
  close(screen);
  waitpid(child, nullptr, 0);
  return shown;
}

TEST(Progress, IsALineOnATerminalAfterTheFirstSecondAndIsWiped) {
  const std::string shown = on_a_terminal(true);
  EXPECT_NE(shown.find("\r\033[Ksimulate "), std::string::npos) << shown;
  EXPECT_NE(shown.find(" s left"), std::string::npos) << shown;
  EXPECT_TRUE(shown.ends_with("\r\033[K")) << shown;
  EXPECT_EQ(shown.find("simulate 5/28"), std::string::npos) << "within the first second: " << shown;
  EXPECT_EQ(on_a_terminal(false), "");
}

}  // namespace
