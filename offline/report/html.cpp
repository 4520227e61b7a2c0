// SPDX-License-Identifier: MIT
#include "offline/report/html.hpp"

#include <cmath>
#include <cstdio>

#include "offline/base/text.hpp"

namespace mdhcal::offline {

namespace {

// Dark enough on white to print; figures and rows of tables do not break over pages.
constexpr const char* style = R"(
@page { size: A4; margin: 15mm; }
body { font: 10.5pt/1.45 sans-serif; color: #111; background: #fff; max-width: 180mm; margin: 8mm auto; padding: 0 4mm; }
h1 { font-size: 17pt; margin: 0 0 2mm; }
h2 { font-size: 12.5pt; margin: 7mm 0 2mm; border-bottom: 0.3mm solid #888; break-after: avoid; }
.verdict { border: 0.4mm solid #2a5d84; background: #eef4f8; padding: 3mm 4mm; margin: 3mm 0; font-size: 11.5pt; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; margin: 2mm 0; font-size: 9pt; }
th, td { border-bottom: 0.2mm solid #bbb; padding: 0.6mm 1.5mm; text-align: left; vertical-align: top; }
table.numeric th:not(:first-child), table.numeric td:not(:first-child) { text-align: right; white-space: nowrap; font-variant-numeric: tabular-nums; }
table.numeric th { white-space: normal !important; }
table.numeric td:last-child { white-space: normal; }
.nowrap { white-space: nowrap; }
tr { break-inside: avoid; }
thead { display: table-header-group; }
p:has(+ .wide), p:has(+ figure) { break-after: avoid; }
figure { margin: 3mm 0; break-inside: avoid; }
figure svg { width: 100%; height: auto; display: block; }
figcaption { font-size: 9pt; color: #333; }
.flag { color: #a02010; font-weight: bold; font-size: 8pt; line-height: 1.1; display: block; }
code { font-size: 8.5pt; overflow-wrap: anywhere; }
@media print { body { margin: 0; padding: 0; max-width: none; } .wide { overflow: visible; } }
)";

}  // namespace

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : printable(text)) {
    switch (c) {
      case '&': out += "&amp;"; break;
      case '<': out += "&lt;"; break;
      case '>': out += "&gt;"; break;
      case '"': out += "&quot;"; break;
      default: out += c;
    }
  }
  return out;
}

std::string number_cell(double value, int digits) {
  if (!std::isfinite(value)) return "-";
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  return text;
}

std::string table(const std::vector<std::vector<std::string>>& rows, bool numeric) {
  std::string out = numeric ? "<div class=\"wide\"><table class=\"numeric\">" : "<div class=\"wide\"><table>";
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (i == 0) out += "<thead>";
    out += "<tr>";
    for (const std::string& cell : rows[i]) {
      out += i == 0 ? "<th>" : "<td>";
      out += cell;
      out += i == 0 ? "</th>" : "</td>";
    }
    out += "</tr>\n";
    if (i == 0) out += "</thead>\n";
  }
  return out + "</table></div>\n";
}

std::string section(const std::string& heading, const std::string& body) {
  return "<section>\n<h2>" + escaped(heading) + "</h2>\n" + body + "</section>\n";
}

std::string page(const std::string& title, const std::string& body) {
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
         "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'; img-src data:\">\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<link rel=\"icon\" href=\"data:,\">\n"
         "<title>" +
         escaped(title) + "</title>\n<style>" + style + "</style>\n</head>\n<body>\n" + body + "</body>\n</html>\n";
}

}  // namespace mdhcal::offline
