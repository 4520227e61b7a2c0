// SPDX-License-Identifier: MIT
#include "offline/import/text.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

#include "offline/base/error.hpp"

namespace mdhcal::offline {

namespace {

// Windows-1252, 0x80 to 0x9F; 0 where it has none.
constexpr std::array<std::uint16_t, 32> windows{
    0x20AC, 0, 0x201A, 0x0192, 0x201E, 0x2026, 0x2020, 0x2021, 0x02C6, 0x2030, 0x0160, 0x2039, 0x0152, 0, 0x017D, 0,
    0, 0x2018, 0x2019, 0x201C, 0x201D, 0x2022, 0x2013, 0x2014, 0x02DC, 0x2122, 0x0161, 0x203A, 0x0153, 0, 0x017E, 0x0178};

void append(std::string& text, std::uint32_t c) {
  const auto byte = [&](std::uint32_t value) { text += static_cast<char>(static_cast<unsigned char>(value)); };
  if (c < 0x80U) {
    byte(c);
  } else if (c < 0x800U) {
    byte(0xC0U | (c >> 6U));
    byte(0x80U | (c & 0x3FU));
  } else if (c < 0x10000U) {
    byte(0xE0U | (c >> 12U));
    byte(0x80U | ((c >> 6U) & 0x3FU));
    byte(0x80U | (c & 0x3FU));
  } else {
    byte(0xF0U | (c >> 18U));
    byte(0x80U | ((c >> 12U) & 0x3FU));
    byte(0x80U | ((c >> 6U) & 0x3FU));
    byte(0x80U | (c & 0x3FU));
  }
}

// Where the text stops to be UTF-8; its size if it never does. (Unicode 15, table 3-7.)
std::size_t first_invalid(std::string_view text) {
  std::size_t at = 0;
  const auto follows = [&](std::size_t k, unsigned low, unsigned high) {
    return at + k < text.size() && static_cast<unsigned char>(text[at + k]) >= low && static_cast<unsigned char>(text[at + k]) <= high;
  };
  while (at < text.size()) {
    const unsigned c = static_cast<unsigned char>(text[at]);
    std::size_t length = 1;
    bool good = c < 0x80U;
    if (c >= 0xC2U && c <= 0xDFU) {
      length = 2;
      good = follows(1, 0x80, 0xBF);
    } else if (c >= 0xE0U && c <= 0xEFU) {
      length = 3;
      good = follows(1, c == 0xE0U ? 0xA0 : 0x80, c == 0xEDU ? 0x9F : 0xBF) && follows(2, 0x80, 0xBF);
    } else if (c >= 0xF0U && c <= 0xF4U) {
      length = 4;
      good = follows(1, c == 0xF0U ? 0x90 : 0x80, c == 0xF4U ? 0x8F : 0xBF) && follows(2, 0x80, 0xBF) && follows(3, 0x80, 0xBF);
    }
    if (!good) return at;
    at += length;
  }
  return at;
}

[[noreturn]] void fail_at(std::string_view text, std::size_t at, const std::string& path, const std::string& message) {
  const std::string_view before = text.substr(0, at);
  const std::size_t line_start = before.rfind('\n') == std::string_view::npos ? 0 : before.rfind('\n') + 1;
  throw InputError(path, 1 + std::count(before.begin(), before.end(), '\n'), 1 + static_cast<long>(at - line_start), message);
}

std::string from_utf16(std::string_view bytes, bool big_endian, const std::string& path) {
  std::string text;
  const auto unit = [&](std::size_t k) {
    const std::uint32_t first = static_cast<unsigned char>(bytes[2 * k]), second = static_cast<unsigned char>(bytes[2 * k + 1]);
    return big_endian ? first << 8U | second : second << 8U | first;
  };
  const std::size_t count = bytes.size() / 2;
  for (std::size_t k = 0; k < count; ++k) {
    std::uint32_t c = unit(k);
    if (c == 0xFEFFU && k == 0) continue;
    if (c >= 0xD800U && c <= 0xDFFFU) {
      const bool pair = c <= 0xDBFFU && k + 1 < count && unit(k + 1) >= 0xDC00U && unit(k + 1) <= 0xDFFFU;
      if (!pair) fail_at(text, text.size(), path, "Found half a character of UTF-16; expected text in UTF-16 or UTF-8.");
      c = 0x10000U + ((c - 0xD800U) << 10U) + (unit(++k) - 0xDC00U);
    }
    append(text, c);
  }
  if (bytes.size() % 2 != 0) fail_at(text, text.size(), path, "Found half a unit of UTF-16 at the end; expected whole text.");
  return text;
}

std::string from_latin1(std::string_view bytes) {
  std::string text;
  for (const char byte : bytes) {
    const std::uint32_t c = static_cast<unsigned char>(byte);
    const bool in_windows = c >= 0x80U && c < 0xA0U && windows[c - 0x80U] != 0;
    append(text, in_windows ? windows[c - 0x80U] : c);
  }
  return text;
}

// Text in UTF-16 of letters and digits has a zero in every other byte: in the odd places, or in the even ones (big endian).
int utf16_by_zeros(std::string_view bytes) {
  std::array<std::size_t, 2> zeros{};
  const std::size_t count = std::min<std::size_t>(bytes.size(), 4096) / 2 * 2;
  for (std::size_t k = 0; k < count; ++k) zeros[k % 2] += bytes[k] == '\0' ? 1U : 0U;
  if (count >= 4 && zeros[0] == 0 && 2 * zeros[1] > count / 2) return 1;
  if (count >= 4 && zeros[1] == 0 && 2 * zeros[0] > count / 2) return 2;
  return 0;
}

}  // namespace

DecodedText decode_text(const std::string& bytes, const std::string& path, const std::string& encoding) {
  if (!encoding.empty() && encoding != "utf-8" && encoding != "utf-16" && encoding != "latin-1") {
    throw InputError("Found the encoding \"" + encoding + "\"; expected utf-8, utf-16 or latin-1.");
  }
  DecodedText out;
  const std::string_view view = bytes;
  const bool little = view.starts_with("\xFF\xFE"), big = view.starts_with("\xFE\xFF");
  const int by_zeros = little || big ? 0 : utf16_by_zeros(view);
  if (encoding == "utf-16" || (encoding.empty() && (little || big || by_zeros != 0))) {
    out = {from_utf16(view, big || by_zeros == 2, path), "utf-16"};
  } else if (encoding == "latin-1") {
    out = {from_latin1(view), "latin-1"};
  } else {
    const std::string_view body = view.starts_with("\xEF\xBB\xBF") ? view.substr(3) : view;
    const std::size_t bad = first_invalid(body);
    if (bad == body.size()) {
      out = {std::string(body), "utf-8"};
    } else if (encoding.empty()) {
      out = {from_latin1(view), "latin-1"};
    } else {
      fail_at(body, bad, path, "Found a byte that is not UTF-8; expected text in UTF-8 as the profile says.");
    }
  }
  const std::size_t nul = out.text.find('\0');
  if (nul != std::string::npos) fail_at(out.text, nul, path, "Found a zero byte; expected text.");
  return out;
}

}  // namespace mdhcal::offline
