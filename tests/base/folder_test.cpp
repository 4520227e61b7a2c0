// SPDX-License-Identifier: MIT
#include "offline/base/folder.hpp"

#include <cstdio>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "offline/base/error.hpp"

namespace {

// What reached the disk and what was renamed, in order: "flush NAME" and "rename NAME".
std::vector<std::string> to_disk;

std::string last_name(const std::filesystem::path& path) { return path.filename().string(); }

}  // namespace

// These stand before the C library's, note the call and pass it on.
extern "C" int fsync(int fd) {
  to_disk.push_back("flush " + last_name(std::filesystem::read_symlink("/proc/self/fd/" + std::to_string(fd))));
  return static_cast<int>(syscall(SYS_fsync, fd));
}

extern "C" int rename(const char* from, const char* to) noexcept {
  to_disk.push_back("rename " + last_name(to));
  return static_cast<int>(syscall(SYS_renameat2, AT_FDCWD, from, AT_FDCWD, to, 0));
}

extern "C" int renameat2(int from_folder, const char* from, int to_folder, const char* to, unsigned flags) noexcept {
  to_disk.push_back("rename " + last_name(to));
  return static_cast<int>(syscall(SYS_renameat2, from_folder, from, to_folder, to, flags));
}

namespace {

namespace fs = std::filesystem;
using mdhcal::offline::InputError;
using mdhcal::offline::OutputFolder;

std::string read(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

class Folder : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (fs::temp_directory_path() / "mdhcal-folder-XXXXXX").string();
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    top_ = pattern;
  }
  void TearDown() override { fs::remove_all(top_); }
  std::ptrdiff_t entries() const { return std::distance(fs::directory_iterator(top_), fs::directory_iterator()); }

  const std::vector<std::string> names_{"a.txt", "b.txt"};
  fs::path top_;
};

TEST_F(Folder, AppearsWholeAtCommitAndNotBefore) {
  {
    OutputFolder folder(top_ / "deep" / "result/", names_);
    folder.write("a.txt", "one");
    EXPECT_FALSE(fs::exists(top_ / "deep" / "result"));
    folder.write("b.txt", "two");
    folder.commit();
  }
  EXPECT_EQ(read(top_ / "deep" / "result" / "a.txt"), "one");
  EXPECT_EQ(read(top_ / "deep" / "result" / "b.txt"), "two");
  EXPECT_EQ(std::distance(fs::directory_iterator(top_ / "deep"), fs::directory_iterator()), 1);
}

TEST_F(Folder, ARelativeNameIsBesideTheWorkingFolder) {
  const fs::path before = fs::current_path();
  fs::current_path(top_);
  {
    OutputFolder folder("plain", names_);
    folder.write("a.txt", "one");
    folder.commit();
  }
  mdhcal::offline::write_file("b.txt", "two");
  fs::current_path(before);
  EXPECT_EQ(read(top_ / "plain" / "a.txt"), "one");
  EXPECT_EQ(read(top_ / "b.txt"), "two");
}

TEST_F(Folder, AnEarlierResultIsExchangedAndAnAbandonedRunLeavesIt) {
  for (const char* text : {"one", "two"}) {
    OutputFolder folder(top_ / "result", names_);
    folder.write("a.txt", text);
    folder.commit();
  }
  EXPECT_EQ(read(top_ / "result" / "a.txt"), "two");
  {
    OutputFolder folder(top_ / "result", names_);
    folder.write("a.txt", "three");
  }
  EXPECT_EQ(read(top_ / "result" / "a.txt"), "two");
  EXPECT_EQ(entries(), 1);
}

// A power cut may come after any of these steps: all bytes and names are on the disk before the rename that shows them.
TEST_F(Folder, IsOnTheDiskBeforeItIsShown) {
  const std::string mark = ".mdhcal-partial-" + std::to_string(getpid());
  const std::string home = last_name(top_);
  for (int again = 0; again < 2; ++again) {  // into an empty place, and in exchange for an earlier result
    OutputFolder folder(top_ / "result", names_);
    to_disk.clear();
    folder.write("a.txt", "one");
    folder.write("b.txt", "two");
    folder.commit();
    EXPECT_EQ(to_disk, (std::vector<std::string>{"flush a.txt", "flush b.txt", "flush .result" + mark, "rename result",
                                                 "flush " + home}));
  }
  to_disk.clear();
  mdhcal::offline::write_file(top_ / "c.txt", "three");
  EXPECT_EQ(to_disk, (std::vector<std::string>{"flush .c.txt" + mark, "rename c.txt", "flush " + home}));
}

TEST_F(Folder, SomethingElseIsRefusedAndUntouched) {
  fs::create_directory(top_ / "home");
  std::ofstream(top_ / "home" / "thesis.tex") << "x";
  EXPECT_THROW(OutputFolder(top_ / "home", names_), InputError);
  std::ofstream(top_ / "file") << "x";
  EXPECT_THROW(OutputFolder(top_ / "file", names_), InputError);
  EXPECT_TRUE(fs::exists(top_ / "home" / "thesis.tex"));
  // A file that arrives in the folder while the command runs is kept too.
  OutputFolder folder(top_ / "result", names_);
  fs::create_directory(top_ / "result");
  std::ofstream(top_ / "result" / "thesis.tex") << "x";
  EXPECT_THROW(folder.commit(), InputError);
  EXPECT_TRUE(fs::exists(top_ / "result" / "thesis.tex"));
}

TEST_F(Folder, LeftoversOfDeadProcessesAreRemovedAndOnlyThose) {
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) _exit(0);
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  const fs::path dead = top_ / (".result.mdhcal-partial-" + std::to_string(child));
  const fs::path alive = top_ / ".result.mdhcal-partial-1";
  const fs::path other = top_ / (".other.mdhcal-partial-" + std::to_string(child));
  for (const fs::path& path : {dead, alive, other}) fs::create_directory(path);
  OutputFolder folder(top_ / "result", names_);
  EXPECT_FALSE(fs::exists(dead));
  EXPECT_TRUE(fs::exists(alive));
  EXPECT_TRUE(fs::exists(other));
}

TEST_F(Folder, AFileIsReplacedWhole) {
  mdhcal::offline::write_file(top_ / "x.csv", "one");
  mdhcal::offline::write_file(top_ / "x.csv", "two");
  EXPECT_EQ(read(top_ / "x.csv"), "two");
  EXPECT_EQ(entries(), 1);
  EXPECT_THROW(mdhcal::offline::write_file(top_ / "no" / "x.csv", "x"), InputError);
  fs::create_directory(top_ / "d");
  EXPECT_THROW(mdhcal::offline::write_file(top_ / "d", "x"), InputError);
  EXPECT_EQ(entries(), 2);
}

TEST_F(Folder, AFileIsWrittenWithoutWhatAKilledRunLeft) {
  const pid_t gone = fork();
  ASSERT_GE(gone, 0);
  if (gone == 0) _exit(0);
  ASSERT_EQ(waitpid(gone, nullptr, 0), gone);
  std::ofstream(top_ / (".a.txt.mdhcal-partial-" + std::to_string(gone))) << "half";
  mdhcal::offline::write_file(top_ / "a.txt", "whole");
  EXPECT_EQ(read(top_ / "a.txt"), "whole");
  EXPECT_EQ(entries(), 1);
}

}  // namespace
