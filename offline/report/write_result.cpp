// SPDX-License-Identifier: MIT
#include "offline/report/write_result.hpp"

#include "offline/identify/usable.hpp"
#include "offline/identify/verdict.hpp"
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
  std::string blob_sha256;
  if (calibration.released()) {
    const Blob blob = calibration_blob(calibration, date);
    const std::string_view bytes(reinterpret_cast<const char*>(blob.data()), blob.size());
    blob_sha256 = sha256_hex(bytes);
    folder.write("calibration.blob", bytes);
    folder.write("corrected.toml", corrected_toml(calibration));
  }
  folder.write("result.json", result_json(calibration, assessment));
  folder.write("residuals.csv", residuals_csv(calibration));
  if (with_report) folder.write("report.html", report_with_provenance(calibration, date, blob_sha256, {}));
}

Calibration concluded(Calibration calibration) {
  const std::string refusal = refusal_of_blob(calibration);
  if (refusal.empty()) return calibration;
  // Nothing to accept: there is no such blob. What is already said about a zero is not said twice.
  if (large_zero_offsets(calibration).empty()) calibration.reasons.push_back(refusal);
  calibration.accepted.clear();
  calibration.verdict = verdict_of(calibration);
  return calibration;
}

}  // namespace mdhcal::offline
