// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <utility>

namespace mdhcal::offline {

/// A file descriptor that closes itself.
class Descriptor {
 public:
  explicit Descriptor(int fd = -1) : fd_(fd) {}
  ~Descriptor();
  Descriptor(Descriptor&& other) noexcept : fd_(other.fd_) { other.fd_ = -1; }
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
  }
  int get() const { return fd_; }

 private:
  int fd_;
};

/// A hidden file or folder beside a destination, in which that is put together before a rename shows it. Its name is
/// random and made by this process (O_EXCL: no link that somebody planted is followed), so two runs never share one, whatever
/// their process ids. While it is being used it is locked (flock): what nobody has locked is a leftover of a killed run, and the
/// next run for the same destination removes it.
class Partial {
 public:
  enum class Kind : std::int32_t { file, folder };
  /// Removes leftovers, then makes a new one, with the rights that the umask leaves of `mode`. Throws InputError if that cannot
  /// be made.
  Partial(const std::filesystem::path& destination, Kind kind, std::uint32_t mode = 0777);
  /// Removes it and all in it, unless kept.
  ~Partial();
  Partial(const Partial&) = delete;
  Partial& operator=(const Partial&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// The open file (to write) or folder.
  int descriptor() const { return open_.get(); }
  /// After a rename to the destination: its old name is nothing of ours any more.
  void keep() { kept_ = true; }

 private:
  std::filesystem::path path_;
  Descriptor open_;
  bool kept_ = false;
};

}  // namespace mdhcal::offline
