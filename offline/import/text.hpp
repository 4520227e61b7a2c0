// SPDX-License-Identifier: MIT
// From the bytes that instruments and spreadsheets write to text in UTF-8.
#pragma once

#include <string>

namespace mdhcal::offline {

struct DecodedText {
  std::string text;      ///< UTF-8 without a byte order mark
  std::string encoding;  ///< "utf-8", "utf-16" or "latin-1", as it was read
};

/// `encoding` is one of those names, or empty: then a byte order mark decides, else UTF-16 if every other byte is mostly
/// zero, else UTF-8 if the bytes are valid UTF-8, else Latin-1 (with Windows' characters in 0x80 to 0x9F).
/// Throws InputError naming line and column: half a UTF-16 unit, a lone surrogate, a zero character, bytes that are not
/// the UTF-8 that was asked for, an unknown name.
DecodedText decode_text(const std::string& bytes, const std::string& path, const std::string& encoding = "");

}  // namespace mdhcal::offline
