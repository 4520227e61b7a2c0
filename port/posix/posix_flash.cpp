// SPDX-License-Identifier: MIT
#include "mdhcal/port/posix_flash.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cinttypes>
#include <climits>
#include <cstdio>
#include <cstring>

#include "mdhcal/port/store.hpp"

namespace mdhcal {

namespace {

// A write or read of n bytes is cut into at most n calls, one byte each: bounded. Signals are no progress, so they are
// counted too.
constexpr int max_interruptions = 1000;

bool write_all(int descriptor, const std::uint8_t* from, std::size_t size, off_t offset) {
  int interruptions = 0;
  while (size > 0) {
    const ssize_t done = pwrite(descriptor, from, size, offset);
    if (done <= 0) {
      if (done < 0 && errno == EINTR && ++interruptions < max_interruptions) continue;
      return false;
    }
    from += done;
    offset += done;
    size -= static_cast<std::size_t>(done);
  }
  return true;
}

bool read_all(int descriptor, std::uint8_t* to, std::size_t size, off_t offset) {
  int interruptions = 0;
  while (size > 0) {
    const ssize_t done = pread(descriptor, to, size, offset);
    if (done <= 0) {
      if (done < 0 && errno == EINTR && ++interruptions < max_interruptions) continue;
      return false;
    }
    to += done;
    offset += done;
    size -= static_cast<std::size_t>(done);
  }
  return true;
}

const PosixFlash& self(void* context) { return *static_cast<PosixFlash*>(context); }

Status read(void* context, std::uint32_t address, std::uint8_t* to, std::uint32_t size) {
  return read_all(self(context).descriptor, to, size, static_cast<off_t>(address)) ? Status::ok : Status::flash_read;
}

// The descriptor is O_DSYNC: a write returns when the bytes are on the disk.
Status program(void* context, std::uint32_t address, const std::uint8_t* granule) {
  const PosixFlash& open = self(context);
  return write_all(open.descriptor, granule, open.flash.geometry.granule_bytes, static_cast<off_t>(address))
             ? Status::ok
             : Status::flash_program;
}

bool fill(int descriptor, const FlashGeometry& geometry, std::uint32_t address) {
  std::uint8_t erased[4096];
  std::memset(erased, geometry.erased_value, sizeof erased);
  for (std::uint32_t done = 0; done < geometry.sector_bytes;) {
    const std::uint32_t left = geometry.sector_bytes - done;
    const std::uint32_t size = left < sizeof erased ? left : static_cast<std::uint32_t>(sizeof erased);
    if (!write_all(descriptor, erased, size, static_cast<off_t>(address) + static_cast<off_t>(done))) return false;
    done += size;
  }
  return true;
}

Status erase(void* context, std::uint32_t address) {
  const PosixFlash& open = self(context);
  return fill(open.descriptor, open.flash.geometry, address) ? Status::ok : Status::flash_erase;
}

bool sync_folder_of(const char* path) {
  char folder[PATH_MAX];
  const char* slash = std::strrchr(path, '/');
  const std::size_t length = slash == nullptr ? 0 : static_cast<std::size_t>(slash - path);
  if (length >= sizeof folder) return false;
  std::memcpy(folder, path, length);
  folder[length] = '\0';
  const char* name = slash == nullptr ? "." : length == 0 ? "/" : folder;
  const int descriptor = ::open(name, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return false;
  const bool done = fsync(descriptor) == 0;
  ::close(descriptor);
  return done;
}

// link() refuses to replace, so of two processes that make the file at once one wins and the other opens the winner's.
// Its name until then is random and new: in a shared folder nobody can have put a link there.
bool make_erased(const char* path, const FlashGeometry& geometry) {
  char beside[PATH_MAX];
  std::uint64_t random = 0;
  if (getrandom(&random, sizeof random, 0) != static_cast<ssize_t>(sizeof random)) return false;
  const int length = std::snprintf(beside, sizeof beside, "%s.%016" PRIx64 ".part", path, random);
  if (length < 0 || static_cast<std::size_t>(length) >= sizeof beside) return false;
  const int descriptor = ::open(beside, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0644);
  if (descriptor < 0) return false;
  bool done = true;
  for (std::uint32_t sector = 0; done && sector < geometry.sector_count; ++sector) {
    done = fill(descriptor, geometry, sector * geometry.sector_bytes);
  }
  done = done && fsync(descriptor) == 0;
  done = ::close(descriptor) == 0 && done;
  done = done && (link(beside, path) == 0 || errno == EEXIST);
  unlink(beside);
  return done && sync_folder_of(path);
}

}  // namespace

Status open_posix_flash(const char* path, const FlashGeometry& geometry, PosixFlash& out) noexcept {
  if (slot_bytes(geometry) == 0) return Status::flash_geometry;
  struct stat file = {};
  if (stat(path, &file) != 0) {
    if (errno != ENOENT) return Status::flash_read;
    if (!make_erased(path, geometry)) return Status::flash_program;
  }
  const int descriptor = ::open(path, O_RDWR | O_DSYNC | O_CLOEXEC);
  if (descriptor < 0) return Status::flash_read;
  Status status = Status::ok;
  if (flock(descriptor, LOCK_EX | LOCK_NB) != 0 || fstat(descriptor, &file) != 0) {
    status = Status::flash_read;
  } else if (file.st_size != static_cast<off_t>(geometry.sector_bytes) * static_cast<off_t>(geometry.sector_count)) {
    status = Status::flash_geometry;
  }
  if (status != Status::ok) {
    ::close(descriptor);
    return status;
  }
  out.descriptor = descriptor;
  out.flash = {geometry, read, program, erase, &out};
  return Status::ok;
}

void close_posix_flash(PosixFlash& open) noexcept {
  if (open.descriptor >= 0) ::close(open.descriptor);
  open.descriptor = -1;
}

}  // namespace mdhcal
