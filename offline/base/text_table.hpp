// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

namespace mdhcal::offline {

/// Rows of cells as lines of text: columns as wide as their widest cell, the first flush left, the others flush right,
/// two blanks between columns.
std::string text_table(const std::vector<std::vector<std::string>>& rows);

/// A number with this many decimals; "0" without a sign where it rounds to zero.
std::string fixed(double value, int decimals);

}  // namespace mdhcal::offline
