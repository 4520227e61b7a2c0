// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace mdhcal::offline {

/// Refuses a text with a character outside ASCII where TOML has none: anywhere but in strings and comments. toml++ 3.3
/// is undefined there (is_unicode_horizontal_whitespace() runs into its TOML_UNREACHABLE, found by fuzzing).
/// Throws InputError naming line and column.
void refuse_stray_characters(const std::string& text, const std::string& path);

}  // namespace mdhcal::offline
