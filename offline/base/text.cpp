// SPDX-License-Identifier: MIT
#include "offline/base/text.hpp"

#include <algorithm>

#include "offline/base/error.hpp"

namespace mdhcal::offline {

namespace {

unsigned byte_at(std::string_view text, std::size_t at) { return static_cast<unsigned char>(text[at]); }

bool continues(std::string_view text, std::size_t at) { return at < text.size() && (byte_at(text, at) & 0xC0U) == 0x80U; }

// C0 and DEL; C1, which UTF-8 writes as C2 80 to C2 9F.
bool is_control(std::string_view character) {
  const unsigned first = byte_at(character, 0);
  return first < 0x20U || first == 0x7FU || (first == 0xC2U && byte_at(character, 1) < 0xA0U);
}

std::string hexadecimal(unsigned byte) {
  constexpr char digits[] = "0123456789ABCDEF";
  return {digits[byte >> 4U], digits[byte & 15U]};
}

[[noreturn]] void refuse_at(std::string_view text, std::size_t at, const std::string& path, const std::string& message) {
  const long line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n');
  const std::size_t before = at == 0 ? std::string_view::npos : text.rfind('\n', at - 1);
  const std::size_t start = before == std::string_view::npos ? 0 : before + 1;
  throw InputError(path, line, static_cast<long>(at - start) + 1, message);
}

}  // namespace

std::size_t character_size(std::string_view text) {
  const unsigned first = byte_at(text, 0);
  if (first < 0x80U) return 1;
  if (first < 0xC2U || first > 0xF4U || !continues(text, 1)) return 0;
  if (first < 0xE0U) return 2;
  // The shortest form only, no surrogates, nothing above U+10FFFF.
  const unsigned second = byte_at(text, 1);
  if ((first == 0xE0U && second < 0xA0U) || (first == 0xEDU && second > 0x9FU) || (first == 0xF0U && second < 0x90U) ||
      (first == 0xF4U && second > 0x8FU) || !continues(text, 2)) {
    return 0;
  }
  if (first < 0xF0U) return 3;
  return continues(text, 3) ? 4 : 0;
}

bool is_utf8(std::string_view text) {
  while (!text.empty()) {
    const std::size_t size = character_size(text);
    if (size == 0) return false;
    text.remove_prefix(size);
  }
  return true;
}

void require_text(std::string_view text, const std::string& path, const std::string& expected) {
  using namespace std::string_view_literals;
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF") || text.starts_with("<\0"sv) || text.starts_with("\0<"sv)) {
    throw InputError(path, 1, 1, "Found text in UTF-16; expected " + expected + " in UTF-8.");
  }
  for (std::size_t at = text.starts_with("\xEF\xBB\xBF") ? 3 : 0; at < text.size();) {
    const unsigned byte = byte_at(text, at);
    if (byte == 0) refuse_at(text, at, path, "Found a zero byte; expected " + expected + " (text in UTF-8).");
    const std::size_t size = character_size(text.substr(at));
    if (size == 0) {
      refuse_at(text, at, path, "Found the byte 0x" + hexadecimal(byte) + ", which is not UTF-8 (Latin-1, perhaps); expected " +
                                  expected + " in UTF-8.");
    }
    if (byte != '\t' && byte != '\n' && byte != '\r' && is_control(text.substr(at, size))) {
      const unsigned code = size == 1 ? byte : byte_at(text, at + 1);
      refuse_at(text, at, path, "Found the control character 0x" + hexadecimal(code) + "; expected " + expected +
                                  " of printable characters.");
    }
    at += size;
  }
}

std::string printable(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  while (!text.empty()) {
    const std::size_t size = character_size(text);
    const bool kept = size != 0 && (text[0] == '\t' || text[0] == '\n' || !is_control(text.substr(0, size)));
    const std::size_t taken = size == 0 ? 1 : size;
    if (kept) {
      out += text.substr(0, size);
    } else {
      for (std::size_t k = 0; k < taken; ++k) out += "\\x" + hexadecimal(byte_at(text, k));
    }
    text.remove_prefix(taken);
  }
  return out;
}

std::string_view begin_of(std::string_view text, std::size_t most) {
  if (text.size() <= most) return text;
  while (most > 0 && (byte_at(text, most) & 0xC0U) == 0x80U) --most;
  return text.substr(0, most);
}

}  // namespace mdhcal::offline
