// SPDX-License-Identifier: MIT
#include "offline/robot/toml_text.hpp"

#include <algorithm>

#include "offline/error.hpp"

namespace mdhcal::offline {

namespace {

// Just behind the string that begins at `from`; a string that does not end reaches to the end of its line, or of the
// text if it may have several lines.
std::size_t behind_string(const std::string& text, std::size_t from) {
  const char quote = text[from];
  const std::string three(3, quote);
  const bool lines = text.compare(from, 3, three) == 0;
  std::size_t at = from + (lines ? 3 : 1);
  while (at < text.size()) {
    if (text[at] == '\\' && quote == '"') {
      at += 2;
    } else if (lines && text.compare(at, 3, three) == 0) {
      // Up to two more quotes belong to the string.
      at += 3;
      for (int more = 0; more < 2 && at < text.size() && text[at] == quote; ++more) ++at;
      return at;
    } else if (!lines && (text[at] == quote || text[at] == '\n')) {
      return at + 1;
    } else {
      ++at;
    }
  }
  return text.size();
}

}  // namespace

void refuse_stray_characters(const std::string& text, const std::string& path) {
  std::size_t at = text.starts_with("\xEF\xBB\xBF") ? 3 : 0;  // a byte order mark
  while (at < text.size()) {
    if (text[at] == '#') {
      at = std::min(text.find('\n', at), text.size());
    } else if (text[at] == '"' || text[at] == '\'') {
      at = behind_string(text, at);
    } else if (static_cast<unsigned char>(text[at]) >= 0x80U) {
      const auto here = text.begin() + static_cast<std::ptrdiff_t>(at);
      const std::size_t line_start = at == 0 ? 0 : text.rfind('\n', at - 1) + 1;
      throw InputError(path, 1 + std::count(text.begin(), here, '\n'), 1 + static_cast<long>(at - line_start),
                       "Found a character outside ASCII; expected one only inside quotes or a comment.");
    } else {
      ++at;
    }
  }
}

}  // namespace mdhcal::offline
