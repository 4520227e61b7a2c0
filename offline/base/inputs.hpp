// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>

struct stat;

namespace mdhcal::offline {

/// Every file that this process has read, by device and inode: what is written must not take the place of one of them. A
/// device or a pipe is none. Safe to call from several threads.

/// Notes that a file is an input; `path` is its name in messages.
void note_input(const struct stat& file, const std::string& path);

/// Throws InputError if the file at `path`, which is about to be written as or removed with `destination`, is an input. Two names
/// of one file (links) are the same file.
void refuse_input(const std::filesystem::path& path, const std::filesystem::path& destination);

}  // namespace mdhcal::offline
