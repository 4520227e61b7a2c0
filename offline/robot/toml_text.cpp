// SPDX-License-Identifier: MIT
#include "offline/robot/toml_text.hpp"

#include <algorithm>
#include <vector>

#include "offline/base/error.hpp"
#include "offline/base/text.hpp"

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

// The parser's own words, without the full stop.
std::string described(const toml::parse_error& error) {
  std::string words(error.description());
  while (!words.empty() && words.back() == '.') words.pop_back();
  return words;
}

bool breaks_parser(const std::string& text) {
  try {
    const auto ignored = toml::parse(text);
  } catch (const toml::parse_error&) {
    return false;
  } catch (const ParserAssertion&) {
    return true;
  }
  return false;
}

// The line in which the parser met the impossible: it reads from the front, so the first so many lines break it if and
// only if they hold that place.
long breaking_line(const std::string& text) {
  std::vector<std::size_t> ends;
  for (std::size_t at = text.find('\n'); at != std::string::npos; at = text.find('\n', at + 1)) ends.push_back(at + 1);
  const auto first = std::partition_point(ends.begin(), ends.end(),
                                          [&](std::size_t end) { return !breaks_parser(text.substr(0, end)); });
  return 1 + static_cast<long>(first - ends.begin());
}

}  // namespace

void fail_assertion() { throw ParserAssertion{}; }

toml::table parse_toml(const std::string& text, const std::string& path) {
  const std::size_t nul = text.find('\0');
  if (nul != std::string::npos) {
    throw InputError(path, 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(nul), '\n'), 1,
                     "Found a zero byte; expected a robot file (TOML text).");
  }
  require_text(text, path, "a robot file (TOML)");
  refuse_stray_characters(text, path);
  try {
    return toml::parse(text, path);
  } catch (const toml::parse_error& error) {
    throw InputError(path, static_cast<long>(error.source().begin.line), static_cast<long>(error.source().begin.column),
                     "Not valid TOML: " + described(error) + "; expected a robot file in TOML.");
  } catch (const ParserAssertion&) {
    throw InputError(path, breaking_line(text), 1,
                     "Not valid TOML: a bracket, a comma or an equals sign stands where a name or a value is expected.");
  }
}

}  // namespace mdhcal::offline
