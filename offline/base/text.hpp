// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace mdhcal::offline {

/// The size of the UTF-8 character at the begin of a text that is not empty [byte]; 0 if it is not well-formed (RFC 3629).
std::size_t character_size(std::string_view text);

/// Whether the whole text is well-formed UTF-8.
bool is_utf8(std::string_view text);

/// The door for every file of text. Throws InputError with line and column (counted in bytes, from 1) unless `text` is
/// UTF-8 without control characters other than tab and line ends; a byte order mark is let through. `expected` names in messages
/// what the file should be, "a measurement file".
void require_text(std::string_view text, const std::string& path, const std::string& expected);

/// Text for people: control characters other than tab and line feed (of Unicode's C0, C1 and DEL), which a terminal would obey,
/// and bytes that are no UTF-8, as a backslash, x and two hexadecimal digits.
std::string printable(std::string_view text);

/// The longest begin of a text that has at most `most` bytes and ends between two characters.
std::string_view begin_of(std::string_view text, std::size_t most);

}  // namespace mdhcal::offline
