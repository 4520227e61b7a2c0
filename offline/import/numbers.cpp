// SPDX-License-Identifier: MIT
#include "offline/import/numbers.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

namespace mdhcal::offline {

namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

// The digits of a whole part whose groups are complete; false if they are not.
bool ungrouped(std::string_view whole, char decimal, std::string& digits) {
  char separator = 0;
  std::size_t group = 0;
  bool first = true;
  for (const char c : whole) {
    if (is_digit(c)) {
      digits += c;
      ++group;
      continue;
    }
    const bool parts = (c == ',' || c == '.' || c == ' ' || c == '\'') && c != decimal && (separator == 0 || separator == c);
    if (!parts || group == 0 || group > 3 || (!first && group != 3)) return false;
    // "0,123" has no groups: nobody writes a zero in front of thousands.
    if (first && digits[0] == '0') return false;
    separator = c;
    first = false;
    group = 0;
  }
  return separator == 0 || group == 3;
}

// Days from 1970-01-01 to a date of the Gregorian calendar (years 1 to 9999).
std::int64_t days_of(std::int64_t year, std::int64_t month, std::int64_t day) {
  // Counted from March, so that the leap day ends a year; 400 years are 146097 days.
  const std::int64_t y = month <= 2 ? year - 1 : year;
  const std::int64_t m = month <= 2 ? month + 9 : month - 3;
  return 365 * y + y / 4 - y / 100 + y / 400 + (153 * m + 2) / 5 + day - 1 - 719468;
}

}  // namespace

std::optional<double> parse_number(std::string_view text, char decimal) {
  std::string plain;
  std::size_t at = 0;
  if (at < text.size() && (text[at] == '+' || text[at] == '-')) {
    if (text[at] == '-') plain += '-';
    ++at;
  }
  const std::size_t end = std::min(text.find_first_of("eEdD", at), text.size());
  const std::string_view mantissa = text.substr(at, end - at);
  const std::size_t point = mantissa.find(decimal);
  const std::string_view whole = mantissa.substr(0, point);
  std::string digits;
  if (!ungrouped(whole, decimal, digits)) return {};
  plain += digits;
  std::size_t count = digits.size();
  if (point != std::string_view::npos) {
    plain += '.';
    for (const char c : mantissa.substr(point + 1)) {
      if (!is_digit(c)) return {};
      plain += c;
      ++count;
    }
  }
  if (count == 0) return {};
  if (end < text.size()) {
    plain += 'e';
    std::string_view exponent = text.substr(end + 1);
    if (!exponent.empty() && (exponent[0] == '+' || exponent[0] == '-')) {
      if (exponent[0] == '-') plain += '-';
      exponent.remove_prefix(1);
    }
    if (exponent.empty()) return {};
    for (const char c : exponent) {
      if (!is_digit(c)) return {};
      plain += c;
    }
  }
  double value = 0;
  const auto parsed = std::from_chars(plain.data(), plain.data() + plain.size(), value);
  if (parsed.ec != std::errc() || parsed.ptr != plain.data() + plain.size() || !std::isfinite(value)) return {};
  return value;
}

bool may_be_number(std::string_view text) { return parse_number(text, '.').has_value() || parse_number(text, ',').has_value(); }

std::optional<double> parse_time(std::string_view text, char decimal) {
  if (text.starts_with('\'')) text.remove_prefix(1);
  if (const auto seconds = parse_number(text, decimal)) return seconds;
  // Whole numbers and the marks between them: 2026-03-02T09:15:00.137Z.
  std::vector<std::int64_t> parts;
  std::string marks;
  double fraction = 0;
  std::size_t at = 0;
  while (at < text.size() && parts.size() < 7) {
    const std::size_t start = at;
    std::int64_t value = 0;
    while (at < text.size() && is_digit(text[at]) && at - start < 9) value = 10 * value + (text[at++] - '0');
    if (at == start) return {};
    if (!marks.empty() && (marks.back() == '.' || marks.back() == ',') && marks.size() > 1 && marks[marks.size() - 2] == ':') {
      fraction = static_cast<double>(value) / std::pow(10.0, static_cast<double>(at - start));
    } else {
      parts.push_back(value);
    }
    if (at == text.size() || (text[at] == 'Z' && at + 1 == text.size())) break;
    char mark = text[at++];
    if (mark == 'T' || mark == '_') mark = ' ';
    while (mark == ' ' && at < text.size() && text[at] == ' ') ++at;
    marks += mark;
  }
  if (at < text.size() && !(text[at] == 'Z' && at + 1 == text.size())) return {};
  std::int64_t days = 0;
  std::size_t clock = 0;
  if (marks.starts_with("--") || marks.starts_with("//") || marks.starts_with("..")) {
    if (parts.size() < 3) return {};
    const bool year_first = parts[0] > 31;
    std::int64_t year = year_first ? parts[0] : parts[2];
    std::int64_t month = parts[1], day = year_first ? parts[2] : parts[0];
    if (marks[0] == '/' && !year_first && parts[0] <= 12) {
      month = parts[0];
      day = parts[1];
    }
    if (year < 100) year += 2000;
    if (month < 1 || month > 12 || day < 1 || day > 31 || year < 1970 || year > 9999) return {};
    days = days_of(year, month, day);
    clock = 3;
    marks.erase(0, std::min<std::size_t>(3, marks.size()));
  }
  if (parts.size() == clock && clock == 3) return 86400.0 * static_cast<double>(days);
  if (parts.size() < clock + 2 || !marks.starts_with(":")) return {};
  const std::int64_t hours = parts[clock], minutes = parts[clock + 1];
  const std::int64_t seconds = parts.size() > clock + 2 ? parts[clock + 2] : 0;
  if (hours > 23 || minutes > 59 || seconds > 60) return {};
  return static_cast<double>(86400 * days + 3600 * hours + 60 * minutes + seconds) + fraction;
}

}  // namespace mdhcal::offline
