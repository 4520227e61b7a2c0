// SPDX-License-Identifier: MIT
// The few pieces of HTML that the pages of this tool are made of.
#pragma once

#include <string>
#include <vector>

namespace mdhcal::offline {

/// Text with the characters that HTML gives a meaning replaced.
std::string escaped(const std::string& text);

/// A number with `digits` decimals; "-" if it is not finite.
std::string number_cell(double value, int digits);

/// A table; the first row is the header. Cells are HTML. Columns from the second on are set right if `numeric`.
std::string table(const std::vector<std::vector<std::string>>& rows, bool numeric = true);

/// A section with its heading.
std::string section(const std::string& heading, const std::string& body);

/// A whole page: no script, no link, nothing fetched (a content security policy forbids it), made for A4.
std::string page(const std::string& title, const std::string& body);

}  // namespace mdhcal::offline
