// SPDX-License-Identifier: MIT
// Files that are compiled into the program (cmake/embed.cmake).
#pragma once

#include <span>
#include <string_view>

namespace mdhcal::offline::embedded {

struct File {
  std::string_view name;  ///< the file's name without ".toml"
  std::string_view text;
};

/// offline/robots/*.toml
std::span<const File> robots();

/// offline/import/profiles/*.toml
std::span<const File> profiles();

}  // namespace mdhcal::offline::embedded
