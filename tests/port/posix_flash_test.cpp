// SPDX-License-Identifier: MIT
#include "mdhcal/port/posix_flash.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "store_fixture.hpp"

namespace {

using namespace mdhcal;
using namespace mdhcal::test;

constexpr FlashGeometry geometry{32, 8192, 2, 0xFF};

class PosixStore : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              ("posix_flash_" + std::to_string(getpid()) + "_" +
               ::testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directory(folder_);
    path_ = (folder_ / "flash.bin").string();
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  // What a start finds: the number of the blob among 0 ... count - 1, or -1.
  int found(int count) {
    PosixFlash flash;
    if (open_posix_flash(path_.c_str(), geometry, flash) != Status::ok) return -1;
    TestLoader loader;
    StoreState state{};
    std::uint8_t buffer[blob_size];
    const Status status = load_newest(flash.flash, loader.loader, buffer, state);
    close_posix_flash(flash);
    for (int i = 0; status == Status::ok && i < count; ++i) {
      if (loader.taken == blob_of(static_cast<std::uint32_t>(i))) return i;
    }
    return -1;
  }

  std::filesystem::path folder_;
  std::string path_;
};

Status put(PosixFlash& flash, std::uint32_t number) {
  TestLoader loader;
  StoreState state{};
  std::uint8_t buffer[blob_size];
  const Status status = load_newest(flash.flash, loader.loader, buffer, state);
  if (status != Status::ok && status != Status::store_empty) return status;
  const Blob blob = blob_of(number);
  return update(flash.flash, loader.loader, blob.data(), blob.size(), state);
}

TEST_F(PosixStore, IsMadeErasedAndKeepsWhatItIsGiven) {
  {
    PosixFlash flash;
    ASSERT_EQ(open_posix_flash(path_.c_str(), geometry, flash), Status::ok);
    EXPECT_EQ(std::filesystem::file_size(path_), 16384U);
    for (std::uint32_t i = 0; i < 3; ++i) ASSERT_EQ(put(flash, i), Status::ok);
    close_posix_flash(flash);
    close_posix_flash(flash);
  }
  EXPECT_EQ(found(3), 2);
  // Nothing lies beside it.
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1);
}

// A link where the file is made, under the name that a process number alone would give: what it leads to stays.
TEST_F(PosixStore, IsNotMadeThroughALinkThatSomeonePut) {
  const std::filesystem::path other = folder_ / "other";
  std::filesystem::create_directory(other);
  std::filesystem::create_symlink(other / "theirs", path_ + '.' + std::to_string(getpid()) + ".part");
  PosixFlash flash;
  EXPECT_EQ(open_posix_flash(path_.c_str(), geometry, flash), Status::ok);
  close_posix_flash(flash);
  EXPECT_TRUE(std::filesystem::is_empty(other));
}

TEST_F(PosixStore, RefusesAnotherSizeASecondOwnerAndAFolderThatIsNotThere) {
  PosixFlash flash;
  ASSERT_EQ(open_posix_flash(path_.c_str(), geometry, flash), Status::ok);
  PosixFlash second;
  EXPECT_EQ(open_posix_flash(path_.c_str(), geometry, second), Status::flash_read);
  close_posix_flash(flash);
  EXPECT_EQ(open_posix_flash(path_.c_str(), {32, 8192, 4, 0xFF}, second), Status::flash_geometry);
  EXPECT_EQ(open_posix_flash(path_.c_str(), {32, 8192, 1, 0xFF}, second), Status::flash_geometry);
  EXPECT_EQ(open_posix_flash((folder_ / "none" / "flash.bin").c_str(), geometry, second), Status::flash_program);
}

TEST_F(PosixStore, AFailingDescriptorIsAStatus) {
  PosixFlash flash;
  ASSERT_EQ(open_posix_flash(path_.c_str(), geometry, flash), Status::ok);
  const std::uint8_t granule[32] = {};
  std::uint8_t byte = 0;
  PosixFlash closed = flash;
  closed.flash.context = &closed;
  closed.descriptor = -1;
  EXPECT_EQ(closed.flash.read(&closed, 0, &byte, 1), Status::flash_read);
  EXPECT_EQ(closed.flash.program(&closed, 0, granule), Status::flash_program);
  EXPECT_EQ(closed.flash.erase(&closed, 0), Status::flash_erase);
  // Behind the end of the file there is nothing to read.
  EXPECT_EQ(flash.flash.read(&flash, 16384, &byte, 1), Status::flash_read);
  close_posix_flash(flash);
}

// A process that updates without pause is killed at some moment, forty times over.
TEST_F(PosixStore, SurvivesBeingKilledInTheMiddleOfUpdates) {
  constexpr int blobs = 8;
  {
    PosixFlash flash;
    ASSERT_EQ(open_posix_flash(path_.c_str(), geometry, flash), Status::ok);
    ASSERT_EQ(put(flash, 0), Status::ok);
    close_posix_flash(flash);
  }
  for (int round = 0; round < 40; ++round) {
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      PosixFlash flash;
      if (open_posix_flash(path_.c_str(), geometry, flash) != Status::ok) _exit(1);
      for (std::uint32_t i = 1;; i = i % (blobs - 1) + 1) {
        if (put(flash, i) != Status::ok) _exit(2);
      }
    }
    usleep(static_cast<useconds_t>(2000 + 1709 * round % 17000));
    kill(child, SIGKILL);
    int status = 0;
    waitpid(child, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status)) << "the child ended by itself";
    ASSERT_GE(found(blobs), 0) << "round " << round;
  }
}

}  // namespace
