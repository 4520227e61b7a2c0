// SPDX-License-Identifier: MIT
#include "offline/base/text.hpp"

#include <gtest/gtest.h>

#include "offline/base/error.hpp"

namespace {

using namespace mdhcal::offline;

// The bytes of a code point, by the definition of RFC 3629.
std::string utf8(unsigned long code) {
  std::string out;
  const auto put = [&](unsigned long byte) { out += static_cast<char>(byte); };
  if (code < 0x80) {
    put(code);
  } else if (code < 0x800) {
    put(0xC0 | code >> 6);
    put(0x80 | (code & 63));
  } else if (code < 0x10000) {
    put(0xE0 | code >> 12);
    put(0x80 | (code >> 6 & 63));
    put(0x80 | (code & 63));
  } else {
    put(0xF0 | code >> 18);
    put(0x80 | (code >> 12 & 63));
    put(0x80 | (code >> 6 & 63));
    put(0x80 | (code & 63));
  }
  return out;
}

TEST(Text, EveryCodePointIsUtf8AndNothingElseOfTheSameBytes) {
  for (unsigned long code = 0; code < 0x110000; ++code) {
    const bool surrogate = code >= 0xD800 && code < 0xE000;
    const std::string bytes = utf8(code);
    ASSERT_EQ(is_utf8(bytes), !surrogate) << code;
    if (!surrogate) {
      ASSERT_EQ(character_size(bytes + "x"), bytes.size()) << code;
    }
    if (code >= 0x80) {
      ASSERT_FALSE(is_utf8(bytes.substr(0, bytes.size() - 1))) << code;
    }
  }
  // What is left of all sequences of up to two bytes, and the begins of longer ones, is refused: overlong, above U+10FFFF, alone.
  for (unsigned first = 0x80; first < 0x100; ++first) {
    EXPECT_FALSE(is_utf8(std::string(1, static_cast<char>(first)))) << first;
    for (unsigned second = 0; second < 0x100; ++second) {
      const std::string pair = {static_cast<char>(first), static_cast<char>(second)};
      const bool good = first >= 0xC2 && first < 0xE0 && second >= 0x80 && second < 0xC0;
      EXPECT_EQ(is_utf8(pair), good) << first << ' ' << second;
    }
  }
  for (const char* bad : {"\xE0\x80\x80", "\xE0\x9F\xBF", "\xED\xA0\x80", "\xF0\x8F\xBF\xBF", "\xF4\x90\x80\x80", "\xF5\x80\x80\x80"}) {
    EXPECT_FALSE(is_utf8(bad));
  }
}

std::string refused(const std::string& text) {
  try {
    require_text(text, "f", "a table");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Text, TheDoorNamesLineAndColumn) {
  EXPECT_EQ(refused("a\tb\r\n\xC3\xA9\xE2\x82\xAC\xF0\x9F\x98\x80\n"), "");
  EXPECT_EQ(refused("\xEF\xBB\xBFq1\n"), "");
  EXPECT_EQ(refused("a\nbc\xE9""d\n").substr(0, 35), "f:2:3: Found the byte 0xE9, which i");
  EXPECT_EQ(refused("ab\x1B[31m").substr(0, 43), "f:1:3: Found the control character 0x1B; ex");
  EXPECT_EQ(refused("ab\n\xC2\x9B").substr(0, 38), "f:2:1: Found the control character 0x9");
  EXPECT_EQ(refused("\x7F").substr(0, 6), "f:1:1:");
  EXPECT_EQ(refused(std::string("a\nb\0c", 5)).substr(0, 24), "f:2:2: Found a zero byte");
  for (const std::string& wide : {std::string("\xFF\xFE<\0", 4), std::string("\xFE\xFF\0<", 4), std::string("<\0?\0", 4), std::string("\0<\0?", 4)}) {
    EXPECT_EQ(refused(wide).substr(0, 26), "f:1:1: Found text in UTF-1");
  }
}

TEST(Text, WhatATerminalObeysIsMadeVisible) {
  EXPECT_EQ(printable("plain \xC3\xA9\n\tline"), "plain \xC3\xA9\n\tline");
  EXPECT_EQ(printable("\x1B]0;title\x07"), "\\x1B]0;title\\x07");
  EXPECT_EQ(printable("\r\x08\x7F"), "\\x0D\\x08\\x7F");
  EXPECT_EQ(printable("\xC2\x9B""2J"), "\\xC2\\x9B2J");
  EXPECT_EQ(printable("caf\xE9"), "caf\\xE9");
  for (unsigned a = 0; a < 256; ++a) {
    for (unsigned b = 0; b < 256; ++b) {
      const std::string shown = printable(std::string{static_cast<char>(a), static_cast<char>(b)});
      ASSERT_TRUE(is_utf8(shown));
      ASSERT_EQ(printable(shown), shown);
    }
  }
}

TEST(Text, IsCutBetweenCharacters) {
  EXPECT_EQ(begin_of("abc", 5), "abc");
  EXPECT_EQ(begin_of("abcd", 3), "abc");
  EXPECT_EQ(begin_of("ab\xE2\x82\xAC", 4), "ab");
  EXPECT_EQ(begin_of("ab\xE2\x82\xAC", 5), "ab\xE2\x82\xAC");
}

}  // namespace
