// SPDX-License-Identifier: MIT
#include "offline/base/folder.hpp"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "offline/base/error.hpp"
#include "offline/base/inputs.hpp"

namespace mdhcal::offline {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void fail(const fs::path& path, const std::string& what, int error) {
  throw InputError(path.string() + ": " + what + ": " + std::strerror(error) + '.');
}

// True once what was written is on the disk; devices and file systems that know no such thing count as well.
bool flushed(int fd) { return fsync(fd) == 0 || errno == EINVAL || errno == EROFS || errno == ENOTSUP; }

// 0, or the error number.
int write_all(int fd, std::string_view bytes) {
  bool good = fd >= 0;
  while (good && !bytes.empty()) {
    const ssize_t count = write(fd, bytes.data(), bytes.size());
    if (count > 0) bytes.remove_prefix(static_cast<std::size_t>(count));
    good = count > 0 || (count < 0 && errno == EINTR);
  }
  // Before any rename: a power cut after it must not find an empty file under the final name.
  return good && flushed(fd) ? 0 : errno;
}

// What is written as it is, without a rename: a stream that this process was given (under its name /dev/stdout, say, which
// must not be replaced), a device or a pipe. -1: none of these.
Descriptor stream_of(const fs::path& path) {
  const std::string name = path.string();
  int given = name == "/dev/stdout" ? STDOUT_FILENO : name == "/dev/stderr" ? STDERR_FILENO : -1;
  for (const std::string_view folder : {"/dev/fd/", "/proc/self/fd/"}) {
    if (!name.starts_with(folder)) continue;
    const char* end = name.data() + name.size();
    if (std::from_chars(name.data() + folder.size(), end, given).ptr != end) given = -1;
  }
  if (given >= 0) {
    const int copy = fcntl(given, F_DUPFD_CLOEXEC, 0);
    if (copy < 0) fail(path, "cannot be written", errno);
    return Descriptor(copy);
  }
  const auto is_stream = [](mode_t mode) { return S_ISCHR(mode) || S_ISFIFO(mode); };
  struct stat found = {};
  if (stat(path.c_str(), &found) != 0 || !is_stream(found.st_mode)) return Descriptor();
  Descriptor open(::open(path.c_str(), O_WRONLY | O_CLOEXEC));
  // It may be another file by now.
  if (open.get() >= 0 && (fstat(open.get(), &found) != 0 || !is_stream(found.st_mode))) return Descriptor();
  if (open.get() < 0) fail(path, "cannot be written", errno);
  return open;
}

// The names in a folder, on the disk. A folder that may be written but not read is left to the file system.
void flush_folder(const fs::path& path) {
  const Descriptor folder(open(path.empty() ? "." : path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (folder.get() >= 0 && !flushed(folder.get())) fail(path, "cannot be written", errno);
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
    refuse_input(entry.path(), destination);
    any = true;
  }
  return any;
}

}  // namespace

void write_file(const fs::path& path, std::string_view bytes) {
  refuse_input(path, path);
  if (const Descriptor stream = stream_of(path); stream.get() >= 0) {
    if (const int error = write_all(stream.get(), bytes)) fail(path, "cannot be written", error);
    return;
  }
  Partial partial(path, Partial::Kind::file);
  int error = write_all(partial.descriptor(), bytes);
  if (error == 0 && std::rename(partial.path().c_str(), path.c_str()) != 0) error = errno;
  if (error != 0) fail(path, "cannot be written", error);
  partial.keep();
  flush_folder(path.parent_path());
}

void write_new_file(const fs::path& path, std::string_view bytes, Access access) {
  Partial partial(path, Partial::Kind::file, access == Access::owner ? 0700U : 0777U);
  int error = write_all(partial.descriptor(), bytes);
  // A second name, since a rename takes the place of what is there; the first one goes with `partial`.
  if (error == 0 && link(partial.path().c_str(), path.c_str()) != 0) error = errno;
  // A file system without links: it refuses to replace in another way, or not at all.
  if (error == EPERM || error == ENOTSUP || error == ENOSYS) {
    error = renameat2(AT_FDCWD, partial.path().c_str(), AT_FDCWD, path.c_str(), RENAME_NOREPLACE) == 0 ? 0 : errno;
    if (error == 0) partial.keep();
  }
  if (error != 0) fail(path, "cannot be written", error);
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
  staging_.emplace(destination_, Partial::Kind::folder);
}

void OutputFolder::write(const std::string& name, std::string_view bytes) {
  if (std::find(names_.begin(), names_.end(), name) == names_.end()) {
    throw std::logic_error(name + " is not a file of this result");
  }
  const Descriptor file(openat(staging_->descriptor(), name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666));
  if (const int error = write_all(file.get(), bytes)) fail(destination_ / name, "cannot be written", error);
}

void OutputFolder::commit() {
  const fs::path& staging = staging_->path();
  flush_folder(staging);
  if (earlier_result(destination_, names_)) {
    if (renameat2(AT_FDCWD, staging.c_str(), AT_FDCWD, destination_.c_str(), RENAME_EXCHANGE) == 0) {
      flush_folder(destination_.parent_path());
      staging_.reset();  // removes the earlier result, which now has this name
      return;
    }
    // A file system that cannot exchange: there is a moment without any result, never one with half of it.
    if (errno != EINVAL && errno != ENOSYS) fail(destination_, "cannot be exchanged", errno);
    fs::remove_all(destination_);
  }
  if (std::rename(staging.c_str(), destination_.c_str()) != 0) fail(destination_, "cannot be put in place", errno);
  staging_->keep();
  flush_folder(destination_.parent_path());
}

}  // namespace mdhcal::offline
