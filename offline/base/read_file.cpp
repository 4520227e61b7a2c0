// SPDX-License-Identifier: MIT
#include "offline/base/read_file.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>

#include <sys/stat.h>

#include "offline/base/error.hpp"
#include "offline/base/inputs.hpp"

namespace mdhcal::offline {

std::string read_file(const std::string& path, const std::string& expected, std::size_t most_bytes) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) {
    throw InputError(path, 0, 0, "Found a folder; expected " + expected + ".");
  }
  const auto closer = [](std::FILE* file) { (void)std::fclose(file); };
  const std::unique_ptr<std::FILE, decltype(closer)> file(std::fopen(path.c_str(), "rb"), closer);
  if (!file) {
    throw InputError(path, 0, 0,
                     std::string("The file cannot be read: ") + std::strerror(errno) + "; expected " + expected + ".");
  }
  struct stat opened = {};
  std::string bytes;
  if (fstat(fileno(file.get()), &opened) == 0) {
    note_input(opened, path);
    // One byte more, so that the end is met without another round.
    if (S_ISREG(opened.st_mode)) bytes.reserve(std::min(static_cast<std::size_t>(opened.st_size), most_bytes) + 1);
  }
  std::size_t used = 0;
  do {
    // Files under /proc and pipes do not tell their size.
    bytes.resize(bytes.capacity() > used + 4096 ? bytes.capacity() : 2 * used + 65536);
    const std::size_t got = std::fread(bytes.data() + used, 1, bytes.size() - used, file.get());
    used += got;
    if (used > most_bytes) {
      throw InputError(path, 0, 0, "Found more than " + std::to_string(most_bytes) + " bytes; expected " + expected + '.');
    }
    if (got == 0) break;
  } while (true);
  bytes.resize(used);
  if (std::ferror(file.get()) != 0) throw InputError(path, 0, 0, "The file cannot be read to its end.");
  return bytes;
}

}  // namespace mdhcal::offline
