// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "offline/identify/calibrate.hpp"
#include "offline/output/folder.hpp"
#include "offline/output/result_json.hpp"
#include "offline/report/report.hpp"

namespace mdhcal::offline {

/// Adds a calibration's files to a folder whose names are result_names; the report only if `with_report`. `context` may
/// name methods that were compared; its provenance is filled in here, the blob's digest included.
void write_result(OutputFolder& folder, const Calibration& calibration, const std::string& date, bool with_report,
                  ReportContext context = {}, const Assessment& assessment = {});

}  // namespace mdhcal::offline
