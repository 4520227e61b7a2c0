// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "offline/identify/calibrate.hpp"

namespace mdhcal::offline {

/// One method's held-out (else training) figures, as `compare` finds them.
struct MethodFigures {
  std::string method;
  Statistics figures;   ///< [mm]
  std::string note;     ///< why it did not converge, or empty
};

/// What a report states beside the calibration itself.
struct ReportContext {
  std::vector<std::pair<std::string, std::string>> provenance;  ///< label and value, in order
  std::vector<MethodFigures> methods;                           ///< empty unless methods were compared
};

/// The report: one HTML page without script or outside resources, figures inlined as SVG. Without gnuplot it says so
/// and keeps its tables. The same calibration gives the same bytes.
std::string report_html(const Calibration& calibration, const ReportContext& context);

}  // namespace mdhcal::offline
