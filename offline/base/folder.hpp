// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "offline/base/partial.hpp"

namespace mdhcal::offline {

/// Writes a file so that it is there whole or not at all: under another name beside it, flushed to the disk, then
/// renamed. A device, a pipe or a stream of this process (/dev/stdout, /dev/fd/3) is written as it is.
/// Throws InputError if it cannot be written, or if it is a file that this process has read (inputs.hpp).
void write_file(const std::filesystem::path& path, std::string_view bytes);

/// Who may read a new file: everyone whom the umask lets, or its owner alone from the first moment.
enum class Access : std::int32_t { all, owner };

/// The same for a file that must not be there yet: what has the name is never written over. Throws InputError if it is taken.
void write_new_file(const std::filesystem::path& path, std::string_view bytes, Access access);

/// A folder of results that appears whole or not at all. Files go to a hidden folder beside it, and commit() puts that
/// in place with one rename (an earlier result is exchanged, then removed) when all of it is on the disk. A run that is
/// killed, or ended by a power cut, leaves the destination as it was; what it left beside it is removed by the next run
/// for the same destination.
class OutputFolder {
 public:
  /// `names` are the files that a result may consist of. Throws InputError if `destination` exists and is not a
  /// folder, or holds anything else: then it is not an earlier result, and nothing in it is touched; or if one of its files is
  /// an input of this process.
  OutputFolder(std::filesystem::path destination, std::vector<std::string> names);
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// Adds a file; `name` is one of the names. Throws InputError if it cannot be written.
  void write(const std::string& name, std::string_view bytes);
  /// Puts the folder in place, once. Throws InputError if the destination changed meanwhile or the file system refuses.
  void commit();

 private:
  std::filesystem::path destination_;
  std::vector<std::string> names_;
  std::optional<Partial> staging_;  // removed with what is in it, unless put in place
};

}  // namespace mdhcal::offline
