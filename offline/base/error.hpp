// SPDX-License-Identifier: MIT
#pragma once

#include <stdexcept>
#include <string>

namespace mdhcal::offline {

/// Bad usage or input: the program ends with exit status 2. The message is a full sentence that names file, line and
/// column where there are any, what was found and what was expected.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
  /// "FILE:LINE:COLUMN: message" (line and column from 1; 0 leaves that part out).
  InputError(const std::string& path, long line, long column, const std::string& message);
};

/// A check that did not hold, or a calibration refused for a stated reason: exit status 1.
class Refusal : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace mdhcal::offline
