// SPDX-License-Identifier: MIT
#include "offline/base/read_file.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>

#include "offline/base/error.hpp"

namespace mdhcal::offline {

std::string read_file(const std::string& path, const std::string& expected) {
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
  std::string bytes;
  const auto size = std::filesystem::file_size(path, ignored);
  if (!ignored) bytes.reserve(static_cast<std::size_t>(size) + 1);
  std::size_t used = 0;
  do {
    // Files under /proc and pipes do not tell their size.
    bytes.resize(bytes.capacity() > used + 4096 ? bytes.capacity() : 2 * used + 65536);
    const std::size_t got = std::fread(bytes.data() + used, 1, bytes.size() - used, file.get());
    used += got;
    if (got == 0) break;
  } while (true);
  bytes.resize(used);
  if (std::ferror(file.get()) != 0) throw InputError(path, 0, 0, "The file cannot be read to its end.");
  return bytes;
}

}  // namespace mdhcal::offline
