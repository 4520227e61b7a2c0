// SPDX-License-Identifier: MIT
#include "offline/base/folder.hpp"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>

#include <fcntl.h>
#include <unistd.h>

#include "offline/base/error.hpp"

namespace mdhcal::offline {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view mark = ".mdhcal-partial-";

[[noreturn]] void fail(const fs::path& path, const std::string& what, int error) {
  throw InputError(path.string() + ": " + what + ": " + std::strerror(error) + '.');
}

fs::path partial_name(const fs::path& path) {
  return path.parent_path() / ('.' + path.filename().string() + std::string(mark) + std::to_string(getpid()));
}

// A descriptor that closes itself.
class Descriptor {
 public:
  Descriptor(const fs::path& path, int flags) : fd_(open(path.c_str(), flags | O_CLOEXEC, 0666)) {}
  ~Descriptor() {
    if (fd_ >= 0) close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return fd_; }

 private:
  int fd_;
};

// True once what was written is on the disk; devices and file systems that know no such thing count as well.
bool flushed(int fd) { return fsync(fd) == 0 || errno == EINVAL || errno == EROFS || errno == ENOTSUP; }

// 0, or the error number.
int write_plain(const fs::path& path, std::string_view bytes) {
  const Descriptor file(path, O_WRONLY | O_CREAT | O_TRUNC);
  bool good = file.get() >= 0;
  while (good && !bytes.empty()) {
    const ssize_t count = write(file.get(), bytes.data(), bytes.size());
    if (count > 0) bytes.remove_prefix(static_cast<std::size_t>(count));
    good = count > 0 || (count < 0 && errno == EINTR);
  }
  // Before any rename: a power cut after it must not find an empty file under the final name.
  return good && flushed(file.get()) ? 0 : errno;
}

// The names in a folder, on the disk. A folder that may be written but not read is left to the file system.
void flush_folder(const fs::path& path) {
  const Descriptor folder(path.empty() ? "." : path, O_RDONLY | O_DIRECTORY);
  if (folder.get() >= 0 && !flushed(folder.get())) fail(path, "cannot be written", errno);
}

// What killed runs for the same destination left: the mark ends in the number of a process that is gone.
void remove_leftovers(const fs::path& destination) {
  const std::string prefix = '.' + destination.filename().string() + std::string(mark);
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(fs::absolute(destination).parent_path(), ignored)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(prefix)) continue;
    const std::string digits = name.substr(prefix.size());
    if (digits.empty() || digits.size() > 9 || digits.find_first_not_of("0123456789") != std::string::npos) continue;
    const int process = std::stoi(digits);
    if (process != getpid() && kill(process, 0) != 0 && errno == ESRCH) fs::remove_all(entry.path(), ignored);
  }
}

// True if there is an earlier result, false if there is nothing or an empty folder.
bool earlier_result(const fs::path& destination, const std::vector<std::string>& names) {
  std::error_code error;
  const fs::file_status status = fs::status(destination, error);
  if (status.type() == fs::file_type::not_found) return false;
  if (error) fail(destination, "cannot be read", error.value());
  if (status.type() != fs::file_type::directory) {
    throw InputError(destination.string() + " is a file; expected a folder, or a name that is free.");
  }
  bool any = false;
  const fs::directory_iterator entries(destination, error);
  if (error) fail(destination, "cannot be read", error.value());
  for (const auto& entry : entries) {
    const std::string name = entry.path().filename().string();
    if (std::find(names.begin(), names.end(), name) == names.end()) {
      throw InputError(destination.string() + " holds \"" + name +
                       "\", so it is not an earlier result of this command; expected such a result, an empty folder "
                       "or a name that is free.");
    }
    any = true;
  }
  return any;
}

}  // namespace

void write_file(const fs::path& path, std::string_view bytes) {
  std::error_code missing;
  const fs::file_type type = fs::status(path, missing).type();
  if (type == fs::file_type::character || type == fs::file_type::fifo) {
    if (const int error = write_plain(path, bytes)) fail(path, "cannot be written", error);
    return;
  }
  remove_leftovers(path);
  const fs::path partial = partial_name(path);
  int error = write_plain(partial, bytes);
  if (error == 0 && std::rename(partial.c_str(), path.c_str()) != 0) error = errno;
  if (error != 0) {
    std::error_code ignored;
    fs::remove(partial, ignored);
    fail(path, "cannot be written", error);
  }
  flush_folder(path.parent_path());
}

OutputFolder::OutputFolder(fs::path destination, std::vector<std::string> names) : names_(std::move(names)) {
  // A trailing slash or a link must not change which folder the new one is written beside.
  std::error_code error;
  destination_ = fs::weakly_canonical(fs::absolute(destination), error);
  if (destination_.filename().empty()) destination_ = destination_.parent_path();
  if (error || destination_.filename().empty()) {
    throw InputError(destination.string() + " cannot be an output folder; expected the name of a folder to write.");
  }
  earlier_result(destination_, names_);
  if (!fs::create_directories(destination_.parent_path(), error) && error) {
    fail(destination_.parent_path(), "cannot be made", error.value());
  }
  remove_leftovers(destination_);
  staging_ = partial_name(destination_);
  fs::remove_all(staging_, error);
  if (!fs::create_directory(staging_, error)) fail(destination_, "cannot be made", error.value());
}

OutputFolder::~OutputFolder() {
  std::error_code ignored;
  if (!committed_) fs::remove_all(staging_, ignored);
}

void OutputFolder::write(const std::string& name, std::string_view bytes) {
  if (std::find(names_.begin(), names_.end(), name) == names_.end()) {
    throw std::logic_error(name + " is not a file of this result");
  }
  if (const int error = write_plain(staging_ / name, bytes)) fail(destination_ / name, "cannot be written", error);
}

void OutputFolder::commit() {
  flush_folder(staging_);
  if (earlier_result(destination_, names_)) {
    if (renameat2(AT_FDCWD, staging_.c_str(), AT_FDCWD, destination_.c_str(), RENAME_EXCHANGE) == 0) {
      committed_ = true;
      flush_folder(destination_.parent_path());
      std::error_code ignored;
      fs::remove_all(staging_, ignored);  // the earlier result now has this name
      return;
    }
    // A file system that cannot exchange: there is a moment without any result, never one with half of it.
    if (errno != EINVAL && errno != ENOSYS) fail(destination_, "cannot be exchanged", errno);
    fs::remove_all(destination_);
  }
  if (std::rename(staging_.c_str(), destination_.c_str()) != 0) fail(destination_, "cannot be put in place", errno);
  committed_ = true;
  flush_folder(destination_.parent_path());
}

}  // namespace mdhcal::offline
