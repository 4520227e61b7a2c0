// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace mdhcal::offline {

/// Writes a file so that it is there whole or not at all: under another name beside it, flushed to the disk, then
/// renamed. A device or a pipe (/dev/stdout) is written as it is.
/// Throws InputError if it cannot be written.
void write_file(const std::filesystem::path& path, std::string_view bytes);

/// A folder of results that appears whole or not at all. Files go to a hidden folder beside it, and commit() puts that
/// in place with one rename (an earlier result is exchanged, then removed) when all of it is on the disk. A run that is
/// killed, or ended by a power cut, leaves the destination as it was; what it left beside it is removed by the next run
/// for the same destination.
class OutputFolder {
 public:
  /// `names` are the files that a result may consist of. Throws InputError if `destination` exists and is not a
  /// folder, or holds anything else: then it is not an earlier result, and nothing in it is touched.
  OutputFolder(std::filesystem::path destination, std::vector<std::string> names);
  /// Without commit(), removes what was written.
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// Adds a file; `name` is one of the names. Throws InputError if it cannot be written.
  void write(const std::string& name, std::string_view bytes);
  /// Puts the folder in place. Throws InputError if the destination changed meanwhile or the file system refuses.
  void commit();

 private:
  std::filesystem::path destination_, staging_;
  std::vector<std::string> names_;
  bool committed_ = false;
};

}  // namespace mdhcal::offline
