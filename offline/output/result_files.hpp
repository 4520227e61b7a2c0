// SPDX-License-Identifier: MIT
// The files of a calibration, as text and bytes.
#pragma once

#include <string>
#include <vector>

#include "offline/identify/calibrate.hpp"
#include "offline/output/blob_writer.hpp"

namespace mdhcal::offline {

/// The names of a calibration's files.
inline const std::vector<std::string> result_names = {"calibration.blob", "corrected.toml", "result.json",
                                                      "residuals.csv", "report.html"};

/// Where a calibration's blob comes from. The rows that judged it are those held out, else those left out of folds. Of a
/// result that is accepted against reasons, the reason given stands in place of the rule of lambda, cut to its room.
Provenance provenance_of(const Calibration& calibration, const std::string& date);

/// The corrected robot as text and, parsed back from that text, as a blob: so `pack corrected.toml` gives the same
/// model bytes.
std::string corrected_toml(const Calibration& calibration);
Blob calibration_blob(const Calibration& calibration, const std::string& date);

/// Why no controller would accept the blob of this calibration, a sentence; empty if one would.
std::string refusal_of_blob(const Calibration& calibration);

/// One sentence: how many parameters are estimated, and which betas.
std::string estimated_text(const Calibration& calibration);
/// How lambda was chosen, and how well the poses tell the parameters, before and after.
std::string choice_text(const Calibration& calibration);
/// The figures before and after as plain text, for stderr.
std::string figures_text(const Calibration& calibration);

}  // namespace mdhcal::offline
