// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "offline/base/folder.hpp"
#include "offline/identify/calibrate.hpp"
#include "offline/output/result_json.hpp"
#include "offline/report/report.hpp"

namespace mdhcal::offline {

/// report_html() with the provenance filled in: files and their digests, what is empty left out. `context` may name
/// methods that were compared.
std::string report_with_provenance(const Calibration& calibration, const std::string& date,
                                   const std::string& blob_sha256, ReportContext context);

/// The calibration with the last reason that may stand against it: that no controller would accept its blob. That reason
/// cannot be overruled by --accept.
Calibration concluded(Calibration calibration);

/// Adds a concluded calibration's files to a folder whose names are result_names; the report only if `with_report`, blob
/// and corrected.toml only if it is released().
void write_result(OutputFolder& folder, const Calibration& calibration, const std::string& date, bool with_report,
                  const Assessment& assessment = {});

}  // namespace mdhcal::offline
