// SPDX-License-Identifier: MIT
// Runs the built program as a user would, and a folder to run it in.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace mdhcal::tests {

/// What a run left.
struct Outcome {
  int exit_code = -1;   ///< 128 + signal if a signal ended it
  std::string out;      ///< stdout
  std::string err;      ///< stderr
};

struct RunOptions {
  std::string input;                                          ///< stdin
  std::string folder;                                         ///< working folder; empty: this one
  std::vector<std::pair<std::string, std::string>> environment;  ///< added; an empty value removes the variable
};

/// Runs the built mdhcal with these arguments (no shell) and waits. SOURCE_DATE_EPOCH is set, so that outputs repeat.
Outcome run_mdhcal(const std::vector<std::string>& arguments, const RunOptions& options = {});

/// The same for any program, searched in PATH.
Outcome run_program(const std::string& program, const std::vector<std::string>& arguments, const RunOptions& options = {});

/// An empty folder, removed with all that is in it at the end of its life.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::string& path() const { return path_; }
  std::string operator/(const std::string& name) const { return path_ + '/' + name; }

 private:
  std::string path_;
};

/// The bytes of a file; an empty string and a test failure if it cannot be read.
std::string read_bytes(const std::string& path);
void write_bytes(const std::string& path, const std::string& bytes);

/// The names in a folder, sorted, the hidden ones too.
std::vector<std::string> names_in(const std::string& folder);

}  // namespace mdhcal::tests
