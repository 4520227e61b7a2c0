// SPDX-License-Identifier: MIT
#include <random>

#include <gtest/gtest.h>

#include "offline/base/error.hpp"
#include "offline/import/meaning.hpp"
#include "offline/import/numbers.hpp"
#include "offline/import/table.hpp"
#include "offline/import/text.hpp"

namespace {

using namespace mdhcal::offline;

TEST(Numbers, GroupsOfThreeAreWholeOrRefused) {
  EXPECT_EQ(parse_number("2,140.2250", '.'), 2140.225);
  EXPECT_EQ(parse_number("-2.140,2250", ','), -2140.225);
  EXPECT_EQ(parse_number("1'234'567.5", '.'), 1234567.5);
  EXPECT_EQ(parse_number("+.5", '.'), 0.5);
  EXPECT_EQ(parse_number("1.5e3", '.'), 1500.0);
  EXPECT_EQ(parse_number("1,5D-3", ','), 0.0015);
  for (const char* bad : {"", "-", ".", "1,23.4", "12,3456.0", "0,123.5", "1,234,56", "1.2.3", "nan", "inf", "0x10", "1e", "1 e5", "--1", "1,234'567.0", "1e999", ",5.0"}) {
    EXPECT_FALSE(parse_number(bad, '.').has_value()) << bad;
  }
}

// What is written with groups and either separator reads back, bit by bit; the other separator then reads another number or none.
TEST(Numbers, OfAnySizeReadBack) {
  std::mt19937_64 generator(3);
  std::uniform_int_distribution<long long> any(0, 999'999'999);
  for (int k = 0; k < 2000; ++k) {
    const long long whole = any(generator) % (k % 2 == 0 ? 1'000'000'000 : 5000);
    std::string digits = std::to_string(whole), grouped;
    for (std::size_t i = 0; i < digits.size(); ++i) {
      if (i > 0 && (digits.size() - i) % 3 == 0) grouped += '.';
      grouped += digits[i];
    }
    const std::string fraction = std::to_string(1000 + any(generator) % 9000);
    const double expected = std::stod(digits + '.' + fraction);
    EXPECT_EQ(parse_number(grouped + ',' + fraction, ','), expected);
    EXPECT_EQ(parse_number(digits + ',' + fraction, ','), expected);
    EXPECT_FALSE(parse_number(grouped + ',' + fraction, '.').has_value()) << grouped << ',' << fraction;
  }
}

TEST(Numbers, TimesAreSecondsSince1970) {
  EXPECT_EQ(parse_time("12.5", '.'), 12.5);
  EXPECT_EQ(parse_time("1970-01-02 00:00:01", '.'), 86401.0);
  EXPECT_EQ(parse_time("2026-03-02T09:15:00.125Z", '.'), 1772442900.125);
  EXPECT_EQ(parse_time("'02.03.2026 09:15:00.125", '.'), 1772442900.125);
  EXPECT_EQ(parse_time("03/02/2026 09:15:00", '.'), 1772442900.0);
  EXPECT_EQ(parse_time("13/02/2026 09:15:00", '.'), 1770974100.0);  // no month 13: the day first
  EXPECT_EQ(parse_time("09:15:00.5", '.'), 33300.5);
  EXPECT_EQ(parse_time("2000-02-29 00:00:00", '.'), 951782400.0);
  for (const char* bad : {"yesterday", "2026-13-01 00:00:00", "09:61:00", "25:00:00", "2026-03", ":", "1:2:3:4:5:6:7:8"}) {
    EXPECT_FALSE(parse_time(bad, '.').has_value()) << bad;
  }
}

TEST(Text, IsTheSameInEveryEncoding) {
  const std::string utf8 = "Pr\xC3\xBC" "fer \xC2\xB5m \xC2\xB0\n";
  const std::string latin = "Pr\xFC" "fer \xB5m \xB0\n";
  std::string little = "\xFF\xFE", big = "\xFE\xFF";
  for (const char c : latin) {
    little += c;
    little += '\0';
    big += '\0';
    big += c;
  }
  EXPECT_EQ(decode_text(utf8, "f").text, utf8);
  EXPECT_EQ(decode_text("\xEF\xBB\xBF" + utf8, "f").text, utf8);
  EXPECT_EQ(decode_text(latin, "f").text, utf8);
  EXPECT_EQ(decode_text(little, "f").text, utf8);
  EXPECT_EQ(decode_text(big, "f").text, utf8);
  EXPECT_EQ(decode_text(little.substr(2), "f").text, utf8);  // without a byte order mark
  EXPECT_EQ(decode_text("\x80", "f").text, "\xE2\x82\xAC");  // Windows' euro sign
  EXPECT_THROW((void)decode_text(little + "\x41", "f"), InputError);
  EXPECT_THROW((void)decode_text(std::string("a\0b,c,d,e,f", 11), "f"), InputError);
  EXPECT_THROW((void)decode_text(latin, "f", "utf-8"), InputError);
  EXPECT_THROW((void)decode_text(std::string("\xFF\xFE\x00\xD8", 4), "f"), InputError);
  EXPECT_THROW((void)decode_text("x", "f", "ebcdic"), InputError);
}

TEST(Tables, TellTheirLayout) {
  const auto table = [](const std::string& text) { return read_text_table(text, "t", Profile{}); };
  EXPECT_EQ(table("P 1\t1.5\t2.5\t3.5\nP 2\t1\t2\t3\n").delimiter, '\t');
  EXPECT_EQ(table("P1;1,5;2,5;3,5\n").delimiter, ';');
  EXPECT_EQ(table("P1;1,5;2,5;3,5\n").decimal, ',');
  EXPECT_EQ(table("P1 1,5 2,5 3,5\n").delimiter, ' ');
  EXPECT_EQ(table("P1, 1.5, 2.5, 3.5\n").delimiter, ',');
  EXPECT_EQ(table("a,x,y,z\n\nP1,1.5,2.5,3.5\n").header, (std::vector<std::string>{"a", "x", "y", "z"}));
  EXPECT_EQ(table("a,x,y,z\n,mm,mm,mm\nP1,1.5,2.5,3.5\n").header, (std::vector<std::string>{"a", "x [mm]", "y [mm]", "z [mm]"}));
  // A first point that was not measured is a row, not a header.
  EXPECT_EQ(table("a,x,y,z\nP1,---,---,---\nP2,1.5,2.5,3.5\n").rows.size(), 2u);
}

TEST(Tables, WhatCannotBeToldIsAsked) {
  const auto refused = [](const std::string& text) {
    try {
      (void)read_text_table(text, "t", Profile{});
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(refused("P1;1,234;2,345;3,456\n").find("--decimal"), std::string::npos);       // thousands or decimals?
  EXPECT_NE(refused("P1;1,5;2.5;3.5\nP2;1;2;3\n").find("t:1:4: "), std::string::npos);     // both
  EXPECT_NE(refused("P1,1.5,2.5,3.5\nP2,1.5,2.5\n").find("t:2:1: Found 3 fields"), std::string::npos);
  EXPECT_NE(refused("P1,1.5,2.5,3.5\n\"P2,1.5,2.5,3.5\n").find("t:2:1: Found a quote"), std::string::npos);
  EXPECT_NE(refused("nothing here\n").find("nothing here"), std::string::npos);  // shown
  EXPECT_FALSE(refused("").empty());
}

TEST(Patterns, FitWithStarsAnywhere) {
  EXPECT_TRUE(fits("Collection\tGroup\tX", "collection*group*x"));
  EXPECT_TRUE(fits("", "*"));
  EXPECT_TRUE(fits("abcabc", "*abc"));
  EXPECT_FALSE(fits("abcab", "*abc"));
  EXPECT_FALSE(fits("abc", "ab"));
  EXPECT_TRUE(fits(std::string(5000, 'a'), "*a*a*a*a*a*"));  // no time that grows with the number of ways
}

TEST(Names, ComeApartByAPattern) {
  const auto parts = parts_of_name("RobotCal::Pose01::A", "{collection}::{id}::{target}");
  ASSERT_TRUE(parts.has_value());
  EXPECT_EQ(parts->at("id"), "Pose01");
  EXPECT_EQ(parts->at("target"), "A");
  EXPECT_EQ(parts_of_name("cal_P7", "cal_{id}")->at("id"), "P7");
  EXPECT_FALSE(parts_of_name("P7", "cal_{id}").has_value());
  EXPECT_FALSE(parts_of_name("", "no braces", true).has_value());
  EXPECT_FALSE(parts_of_name("", "{id}{target}", true).has_value());
  EXPECT_FALSE(parts_of_name("", "{who}", true).has_value());
}

TEST(Profiles, BuiltInOnesAreValidAndOthersAreRefusedWithTheirPlace) {
  for (const std::string& name : profile_names()) {
    const Profile profile = find_profile(name);
    EXPECT_FALSE(profile.about.empty()) << name;
  }
  const auto refused = [](const std::string& text) {
    try {
      (void)parse_profile(text, "p.toml", "p");
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(refused("delimter = \",\"").find("p.toml:1:1: Unknown key \"delimter\""), std::string::npos);
  EXPECT_NE(refused("\ndelimiter = \"|\"").find("p.toml:2:"), std::string::npos);
  EXPECT_NE(refused("columns = [\"id\", \"xx\"]").find("\"xx\""), std::string::npos);
  EXPECT_NE(refused("rotation = \"rpx\"").find("rpx"), std::string::npos);
  EXPECT_NE(refused("coverage = 0").find("p.toml:1:"), std::string::npos);
  EXPECT_NE(refused("columns = [\"id\"]\n[rename]\nid = \"a\"\n").find("by position or by name"), std::string::npos);
  EXPECT_THROW((void)find_profile("no-such-profile"), InputError);
}

}  // namespace
