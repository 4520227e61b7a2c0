// SPDX-License-Identifier: MIT
// Measurement files as a user brings them, made of a simulated dataset column by column.
#pragma once

#include <cmath>
#include <cstdio>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "offline/measure/dataset.hpp"

namespace mdhcal::tests {

inline std::string decimal(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

/// One column: its header and what stands in a row of the dataset.
using TableColumn = std::pair<std::string, std::function<std::string(std::size_t row)>>;
using TableColumns = std::vector<TableColumn>;

inline std::string measured_table(std::size_t rows, const TableColumns& columns) {
  std::string text;
  for (const TableColumn& column : columns) text += (text.empty() ? "" : ",") + column.first;
  text += '\n';
  for (std::size_t row = 0; row < rows; ++row) {
    std::string line;
    for (const TableColumn& column : columns) line += ',' + column.second(row);
    text += line.substr(1) + '\n';
  }
  return text;
}

inline TableColumn id_column(const offline::Dataset& data) {
  return {"id", [&data](std::size_t row) { return data.rows[row].id; }};
}

/// q1_deg ... of revolute joints; `suffix` "_cmd_deg" for commanded readings, `change` what is added [rad].
inline TableColumns joint_columns(const offline::Dataset& data, const std::string& suffix = "_deg",
                                  const std::function<double(std::size_t row, std::size_t joint)>& change = {}) {
  TableColumns columns;
  for (std::size_t j = 0; j < data.joint_count; ++j) {
    columns.emplace_back("q" + std::to_string(j + 1) + suffix, [&data, j, change](std::size_t row) {
      return decimal((data.rows[row].q[j] + (change ? change(row, j) : 0.0)) * 57.29577951308232);
    });
  }
  return columns;
}

inline TableColumns position_columns(const offline::Dataset& data) {
  TableColumns columns;
  const char* const names[] = {"x_mm", "y_mm", "z_mm"};
  for (std::size_t k = 0; k < 3; ++k) {
    columns.emplace_back(names[k],
                         [&data, k](std::size_t row) { return decimal(1e3 * data.rows[row].position_m[k]); });
  }
  return columns;
}

inline TableColumns operator+(TableColumns a, const TableColumns& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

}  // namespace mdhcal::tests
