// SPDX-License-Identifier: MIT
// Numbers and lists as they stand in sentences.
#pragma once

#include <string>
#include <vector>

namespace mdhcal::offline {

/// Three significant digits, or `decimals` behind the point.
std::string number(double value);
std::string number(double value, int decimals);

/// "a", "a and b", "a, b and c".
std::string joined(const std::vector<std::string>& words);

}  // namespace mdhcal::offline
