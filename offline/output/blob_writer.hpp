// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "mdhcal/blob.hpp"
#include "offline/robot/robot.hpp"

namespace mdhcal::offline {

/// The bytes of a parameter blob (docs/blob.md).
using Blob = std::array<std::uint8_t, blob_size>;

/// Where a blob comes from. Everything may be left empty: a plain `pack` has a tool version and a date.
struct Provenance {
  std::string tool_version = MDHCAL_TOOL_VERSION;  ///< at most 31 bytes
  std::string date;                 ///< YYYY-MM-DD, as blob_date() gives it; empty: none
  std::string method;               ///< as --method names it; at most 15 bytes
  std::string lambda_rule;          ///< as --lambda-rule names it; at most 31 bytes
  std::string measurements_sha256;  ///< Dataset::digest_sha256, 64 hexadecimal digits; empty: no measurements
  std::uint32_t pose_count = 0;     ///< poses that the identification used; 0 without measurements
  std::optional<double> lambda;     ///< [mm^2], or [1] where the residuals have a sigma

  /// Position errors on the poses that judged the identification.
  struct HeldOut {
    std::uint32_t pose_count = 0;
    double mean_before_m = 0, max_before_m = 0;  ///< nominal geometry [m]
    double mean_after_m = 0, max_after_m = 0;    ///< corrected geometry [m]
  };
  std::optional<HeldOut> held_out;
};

/// The date for a blob: `given` (--date) if it is one, else the day of SOURCE_DATE_EPOCH, else today, in UTC.
/// Throws InputError if `given` is not a date of the form YYYY-MM-DD, or SOURCE_DATE_EPOCH not a number of seconds.
std::string blob_date(const std::optional<std::string>& given);

/// The model that a robot's blob holds, with self-test vectors computed through lib. [tool] becomes the target point
/// "tool" if the robot names no target. Throws InputError if the robot does not fit in a blob, Refusal if the
/// corrected geometry is further from its nominal than the library accepts.
BlobContent make_model(const Robot& robot, const Provenance& provenance);

/// The bytes of a model: decode() gives the model back, and encode(decode(bytes)) gives the bytes back.
Blob encode(const BlobContent& model);

/// encode(make_model()). The same robot and provenance give the same bytes.
Blob make_blob(const Robot& robot, const Provenance& provenance);

}  // namespace mdhcal::offline
