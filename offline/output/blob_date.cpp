// SPDX-License-Identifier: MIT
#include <charconv>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "offline/base/error.hpp"
#include "offline/output/blob_writer.hpp"

namespace mdhcal::offline {

namespace {

std::string text_of(std::chrono::year_month_day day) {
  char text[32];
  std::snprintf(text, sizeof text, "%04d-%02u-%02u", static_cast<int>(day.year()), static_cast<unsigned>(day.month()),
                static_cast<unsigned>(day.day()));
  return text;
}

bool is_date(const std::string& text) {
  if (text.size() != 10 || text[4] != '-' || text[7] != '-') return false;
  int year = 0;
  unsigned month = 0;
  unsigned day = 0;
  const auto digits = [&](std::size_t from, std::size_t count, auto& value) {
    const char* end = text.data() + from + count;
    return text[from] != '-' && std::from_chars(text.data() + from, end, value).ptr == end;
  };
  return digits(0, 4, year) && digits(5, 2, month) && digits(8, 2, day) &&
         (std::chrono::year(year) / std::chrono::month(month) / std::chrono::day(day)).ok();
}

}  // namespace

std::string blob_date(const std::optional<std::string>& given) {
  if (given) {
    if (is_date(*given)) return *given;
    throw InputError("--date is '" + *given + "', expected a date of the form YYYY-MM-DD.");
  }
  std::chrono::sys_seconds now = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
  if (const char* epoch = std::getenv("SOURCE_DATE_EPOCH")) {
    long long seconds = 0;
    const char* end = epoch + std::strlen(epoch);
    const auto [stop, error] = std::from_chars(epoch, end, seconds);
    constexpr long long year_9999 = 253402300799;
    if (error != std::errc{} || stop != end || seconds < 0 || seconds > year_9999) {
      throw InputError(std::string("SOURCE_DATE_EPOCH is '") + epoch + "', expected seconds since 1970, up to year 9999.");
    }
    now = std::chrono::sys_seconds(std::chrono::seconds(seconds));
  }
  return text_of(std::chrono::year_month_day(std::chrono::floor<std::chrono::days>(now)));
}

}  // namespace mdhcal::offline
