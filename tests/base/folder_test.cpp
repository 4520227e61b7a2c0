// SPDX-License-Identifier: MIT
#include "offline/base/folder.hpp"

#include <cstdio>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <csignal>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "offline/base/error.hpp"
#include "offline/base/read_file.hpp"

namespace {

// What reached the disk and what was renamed, in order: "flush NAME" and "rename NAME".
std::vector<std::string> to_disk;

// The last part of a path; the random end of a partial name as "...".
std::string last_name(const std::filesystem::path& path) {
  const std::string name = path.filename().string();
  const std::size_t mark = name.find(".mdhcal-partial-");
  return mark == std::string::npos ? name : name.substr(0, mark) + ".mdhcal-partial-...";
}

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
  const std::string mark = ".mdhcal-partial-...";
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

TEST_F(Folder, LeftoversOfKilledRunsAreRemovedAndNothingElse) {
  int ready[2];
  ASSERT_EQ(pipe(ready), 0);
  const pid_t killed = fork();
  ASSERT_GE(killed, 0);
  if (killed == 0) {
    OutputFolder folder(top_ / "result", names_);
    folder.write("a.txt", "half");
    (void)!write(ready[1], "x", 1);
    for (;;) pause();
  }
  char byte = 0;
  ASSERT_EQ(::read(ready[0], &byte, 1), 1);
  OutputFolder running(top_ / "result", names_);
  EXPECT_EQ(entries(), 2) << "the other one still runs";
  kill(killed, SIGKILL);
  ASSERT_EQ(waitpid(killed, nullptr, 0), killed);
  // Not ours by their names: another destination's, one that is no random number, and a plain file.
  const fs::path others[] = {top_ / ".other.mdhcal-partial-0123456789abcdef", top_ / ".result.mdhcal-partial-1",
                             top_ / ".result.mdhcal-partial-0123456789abcdeg"};
  for (const fs::path& path : others) fs::create_directory(path);
  OutputFolder next(top_ / "result", names_);
  EXPECT_EQ(entries(), 2 + 3);
  for (const fs::path& path : others) EXPECT_TRUE(fs::exists(path));
  // What runs is not disturbed.
  running.write("a.txt", "one");
  running.commit();
  EXPECT_EQ(read(top_ / "result" / "a.txt"), "one");
}

// Many at once for one destination, threads and processes that know nothing of each other: one result stands, unmixed, and
// nothing is left beside it.
TEST_F(Folder, RunsAtTheSameTimeNeverMix) {
  const auto run = [&](const std::string& text) {
    for (int turn = 0; turn < 20; ++turn) {
      try {
        OutputFolder folder(top_ / "result", names_);
        folder.write("a.txt", text);
        folder.write("b.txt", text);
        folder.commit();
        mdhcal::offline::write_file(top_ / "single.txt", text);
      } catch (const InputError&) {  // another one was put in place at this moment
      }
    }
  };
  std::vector<pid_t> children;
  for (const char* text : {"one", "two", "three"}) {
    children.push_back(fork());
    if (children.back() == 0) {
      run(text);
      _exit(0);
    }
  }
  for (const pid_t child : children) {
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    EXPECT_EQ(status, 0);
  }
  EXPECT_EQ(read(top_ / "result" / "a.txt"), read(top_ / "result" / "b.txt"));
  EXPECT_NE(read(top_ / "result" / "a.txt"), "");
  EXPECT_EQ(entries(), 2);
}

// In a folder that others may write to, links stand under every name that could be foreseen.
TEST_F(Folder, PlantedLinksAreNotFollowed) {
  std::ofstream(top_ / "victim") << "precious";
  for (int pid = getpid() - 50; pid < getpid() + 50; ++pid) {
    for (const char* name : {".a.txt", ".result"}) {
      fs::create_symlink(top_ / "victim", top_ / (std::string(name) + ".mdhcal-partial-" + std::to_string(pid)));
    }
  }
  fs::create_symlink(top_ / "victim", top_ / ".a.txt.mdhcal-partial-0123456789abcdef");
  fs::create_symlink(top_ / "victim", top_ / "a.txt");
  mdhcal::offline::write_file(top_ / "a.txt", "new");
  OutputFolder folder(top_ / "result", names_);
  folder.write("a.txt", "one");
  folder.commit();
  EXPECT_EQ(read(top_ / "victim"), "precious");
  EXPECT_FALSE(fs::is_symlink(top_ / "a.txt"));
  EXPECT_EQ(read(top_ / "a.txt"), "new");
  EXPECT_TRUE(fs::is_directory(fs::symlink_status(top_ / "result")));
}

TEST_F(Folder, AnInputIsNeverWrittenOver) {
  using mdhcal::offline::read_file;
  using mdhcal::offline::write_file;
  std::ofstream(top_ / "in") << "precious";
  // Kept open to the end of the program: its inode, which the process knows as an input, must not be another test's file.
  ASSERT_GE(open((top_ / "in").c_str(), O_RDONLY | O_CLOEXEC), 0);
  ASSERT_EQ(read_file((top_ / "in").string(), "a file"), "precious");
  fs::create_hard_link(top_ / "in", top_ / "hard");
  fs::create_symlink("in", top_ / "soft");
  fs::create_directory(top_ / "d");
  for (const fs::path& path : {top_ / "in", top_ / "hard", top_ / "soft", top_ / "d" / ".." / "in"}) {
    EXPECT_THROW(write_file(path, "x"), InputError) << path;
  }
  fs::create_directory(top_ / "result");
  fs::create_hard_link(top_ / "in", top_ / "result" / "b.txt");
  EXPECT_THROW(OutputFolder(top_ / "result", names_), InputError);
  EXPECT_EQ(read(top_ / "in"), "precious");
  // One that is read only after the folder was begun.
  fs::remove(top_ / "result" / "b.txt");
  std::ofstream(top_ / "result" / "a.txt") << "earlier";
  OutputFolder folder(top_ / "result", names_);
  folder.write("a.txt", "new");
  ASSERT_GE(open((top_ / "result" / "a.txt").c_str(), O_RDONLY | O_CLOEXEC), 0);
  ASSERT_EQ(read_file((top_ / "result" / "a.txt").string(), "a file"), "earlier");
  EXPECT_THROW(folder.commit(), InputError);
  EXPECT_EQ(read(top_ / "result" / "a.txt"), "earlier");
  write_file(top_ / "out", "free");
  EXPECT_EQ(read(top_ / "out"), "free");
}

// A stream has a name too, which is not to be replaced by a file.
TEST_F(Folder, AStreamIsWrittenAndItsNameStays) {
  const int file = open((top_ / "stream").c_str(), O_RDWR | O_CREAT | O_APPEND, 0600);
  ASSERT_GE(file, 0);
  ASSERT_EQ(write(file, "before ", 7), 7);
  for (const char* folder : {"/dev/fd/", "/proc/self/fd/"}) mdhcal::offline::write_file(folder + std::to_string(file), "x");
  EXPECT_EQ(read(top_ / "stream"), "before xx");
  EXPECT_THROW(mdhcal::offline::write_file("/dev/fd/999", "x"), InputError);
  close(file);
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

}  // namespace
