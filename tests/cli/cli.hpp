// SPDX-License-Identifier: MIT
// What the end-to-end tests share.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include "tests/support/program.hpp"

namespace mdhcal::tests {

/// A file of the shipped example.
inline std::string example(const std::string& name) {
  return std::string(MDHCAL_SOURCE_DIR) + "/offline/examples/li2022/" + name;
}

/// A plain table: commas, a header, `#` lines skipped. Read apart from the program's own reader.
class CsvTable {
 public:
  explicit CsvTable(const std::string& text) {
    std::size_t at = 0;
    while (at < text.size()) {
      std::size_t end = text.find('\n', at);
      if (end == std::string::npos) end = text.size();
      const std::string line = text.substr(at, end - at);
      at = end + 1;
      if (line.empty() || line[0] == '#') continue;
      if (header_.empty()) {
        const auto names = split(line);
        for (std::size_t k = 0; k < names.size(); ++k) header_[names[k]] = k;
      } else {
        rows_.push_back(split(line));
      }
    }
  }

  std::size_t rows() const { return rows_.size(); }
  bool has(const std::string& column) const { return header_.count(column) == 1; }

  std::string text(std::size_t row, const std::string& column) const {
    const auto found = header_.find(column);
    if (found == header_.end() || row >= rows_.size() || found->second >= rows_[row].size()) {
      ADD_FAILURE() << "no field " << column << " in row " << row;
      return "";
    }
    return rows_[row][found->second];
  }

  double number(std::size_t row, const std::string& column) const {
    const std::string field = text(row, column);
    char* end = nullptr;
    const double value = std::strtod(field.c_str(), &end);
    if (field.empty() || *end != 0) ADD_FAILURE() << "not a number in " << column << ", row " << row << ": " << field;
    return value;
  }

 private:
  static std::vector<std::string> split(const std::string& line) {
    std::vector<std::string> fields(1);
    for (const char c : line) {
      if (c == ',') {
        fields.emplace_back();
      } else {
        fields.back() += c;
      }
    }
    return fields;
  }

  std::map<std::string, std::size_t> header_;
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace mdhcal::tests
