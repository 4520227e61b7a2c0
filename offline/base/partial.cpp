// SPDX-License-Identifier: MIT
#include "offline/base/partial.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <random>
#include <string>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "offline/base/error.hpp"

namespace mdhcal::offline {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view name_digits = "0123456789abcdef";
constexpr std::size_t random_digits = 16;  // 64 bits: 10^6 runs at once meet with a chance of 3e-8

std::string prefix_of(const fs::path& destination) { return '.' + destination.filename().string() + ".mdhcal-partial-"; }

std::string random_name(const fs::path& destination) {
  std::random_device source;
  std::string name = prefix_of(destination);
  for (std::size_t k = 0; k < random_digits; ++k) name += name_digits[source() % 16U];
  return name;
}

bool same_file(const struct stat& a, const struct stat& b) { return a.st_dev == b.st_dev && a.st_ino == b.st_ino; }

// Whether the open file still has this name. It has lost it if a cleaner came between its making and its locking.
bool still_named(int fd, const fs::path& path) {
  struct stat open = {}, named = {};
  return fstat(fd, &open) == 0 && lstat(path.c_str(), &named) == 0 && same_file(open, named);
}

// Removes what killed runs of this user left for the same destination: what has such a name and no lock.
void remove_leftovers(const fs::path& destination) {
  const std::string prefix = prefix_of(destination);
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(fs::absolute(destination).parent_path(), ignored)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(prefix)) continue;
    const std::string tail = name.substr(prefix.size());
    if (tail.size() != random_digits || tail.find_first_not_of(name_digits) != std::string::npos) continue;
    const Descriptor open(::open(entry.path().c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
    struct stat found = {};
    if (open.get() < 0 || fstat(open.get(), &found) != 0 || found.st_uid != geteuid()) continue;
    if (!S_ISREG(found.st_mode) && !S_ISDIR(found.st_mode)) continue;
    if (flock(open.get(), LOCK_EX | LOCK_NB) == 0 && still_named(open.get(), entry.path())) fs::remove_all(entry.path(), ignored);
  }
}

}  // namespace

Descriptor::~Descriptor() {
  if (fd_ >= 0) close(fd_);
}

Partial::Partial(const fs::path& destination, Kind kind, std::uint32_t mode) {
  remove_leftovers(destination);
  int error = 0;
  for (int turn = 0; turn < 100; ++turn) {  // another turn where a name was taken, or where a cleaner was quicker
    path_ = destination.parent_path() / random_name(destination);
    bool made = true;
    if (kind == Kind::file) {
      open_ = Descriptor(::open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, mode & 0666U));
      made = open_.get() >= 0;
    } else {
      made = mkdir(path_.c_str(), mode) == 0;
      if (made) open_ = Descriptor(::open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
    }
    error = errno;
    if (!made && error != EEXIST) break;
    // A file system without locks has no leftovers removed either.
    if (!made || (flock(open_.get(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)) continue;
    if (still_named(open_.get(), path_)) return;
  }
  throw InputError(destination.string() + ": cannot be written: " + std::strerror(error) + '.');
}

Partial::~Partial() {
  std::error_code ignored;
  if (!kept_) fs::remove_all(path_, ignored);
}

}  // namespace mdhcal::offline
