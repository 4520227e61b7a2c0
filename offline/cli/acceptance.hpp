// SPDX-License-Identifier: MIT
// What makes `verify` an acceptance test: ISO 9283 figures of repeated poses, and the drift against an earlier blob.
#pragma once

#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "offline/cli/blob_registration.hpp"

namespace mdhcal::offline {

struct AcceptanceOptions {
  bool iso9283 = false;
  std::optional<double> max_ap_mm, max_rp_mm;  ///< limits on pose accuracy and repeatability; imply iso9283
  std::string against;                         ///< an earlier blob
  std::optional<double> max_drift_mm;

  void add_to(CLI::App& command);
};

struct Acceptance {
  std::string text;              ///< for people
  nlohmann::ordered_json json;   ///< `iso9283` and `drift`, as far as asked for
  std::string broken;            ///< a sentence for each limit that did not hold, each followed by a blank
};

/// Throws InputError if drift is asked to be limited without an earlier blob, or if no pose is repeated.
Acceptance accept(const AcceptanceOptions& options, const Arm<double>& arm, const Registration& registration,
                  const Dataset& data, bool refit_base, bool refit_tool);

}  // namespace mdhcal::offline
