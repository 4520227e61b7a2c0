// SPDX-License-Identifier: MIT
#include "offline/report/write_result.hpp"

#include "offline/measure/digest.hpp"
#include "offline/output/residuals_csv.hpp"
#include "offline/output/result_files.hpp"
#include "offline/output/result_json.hpp"

namespace mdhcal::offline {

std::string report_with_provenance(const Calibration& calibration, const std::string& date,
                                   const std::string& blob_sha256, ReportContext context) {
  auto& provenance = context.provenance;
  const auto add = [&](const char* label, const std::string& value) {
    if (!value.empty()) provenance.emplace_back(label, value);
  };
  add("tool", MDHCAL_TOOL_VERSION);
  add("date", date);
  add("robot file", calibration.robot.path);
  add("serial", calibration.robot.serial);
  add("measurements", calibration.training.path);
  add("SHA-256 of the measurements", calibration.training.digest_sha256);
  if (calibration.test && calibration.testing.path != calibration.training.path) {
    add("test measurements", calibration.testing.path);
    add("SHA-256 of the test measurements", calibration.testing.digest_sha256);
  }
  add("SHA-256 of calibration.blob", blob_sha256);
  return report_html(calibration, context);
}

void write_result(OutputFolder& folder, const Calibration& calibration, const std::string& date, bool with_report,
                  const Assessment& assessment) {
  const Blob blob = calibration_blob(calibration, date);
  const std::string_view bytes(reinterpret_cast<const char*>(blob.data()), blob.size());
  folder.write("calibration.blob", bytes);
  folder.write("corrected.toml", corrected_toml(calibration));
  folder.write("result.json", result_json(calibration, assessment));
  folder.write("residuals.csv", residuals_csv(calibration));
  if (with_report) folder.write("report.html", report_with_provenance(calibration, date, sha256_hex(bytes), {}));
}

}  // namespace mdhcal::offline
