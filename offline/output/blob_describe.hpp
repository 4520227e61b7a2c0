// SPDX-License-Identifier: MIT
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "offline/output/blob_file.hpp"

namespace mdhcal::offline {

/// Everything in a blob as JSON: millimetres and degrees under keys that say so. Self-test vectors are in the units of
/// the library (metres, radians), because their bits matter; `double_here` says how they went on this machine.
nlohmann::ordered_json describe_json(const BlobFile& file);

/// describe_json() as text for people.
std::string describe_text(const nlohmann::ordered_json& blob);

/// What changed from blob `a` to blob `b`: parameters, limits, base, targets, provenance, and how far the flange moves over
/// 1000 joint vectors within the limits (fixed seed). Throws InputError if the arms have other numbers or kinds of joints.
nlohmann::ordered_json difference_json(const BlobContent& a, const BlobContent& b);

/// difference_json() as text.
std::string difference_text(const nlohmann::ordered_json& difference);

}  // namespace mdhcal::offline
