// SPDX-License-Identifier: MIT
// A line of the trace, written to the debugger's console in one piece when it is complete.
#pragma once

#include <cstdint>
#include <cstring>

#include "semihosting.h"

namespace firmware {

class Line {
 public:
  explicit Line(const char* begin) { *this << begin; }
  Line(const Line&) = delete;
  Line& operator=(const Line&) = delete;
  ~Line() {
    text_[used_] = '\n';
    text_[used_ + 1] = '\0';
    semihosting_write(text_);
  }

  Line& operator<<(const char* text) {
    while (*text != '\0' && used_ < capacity) text_[used_++] = *text++;
    return *this;
  }
  Line& operator<<(std::uint32_t value) {
    char digits[11] = {};
    int at = 10;
    do {
      digits[--at] = static_cast<char>('0' + value % 10U);
      value /= 10U;
    } while (value != 0U);
    return *this << digits + at;
  }
  Line& operator<<(std::int32_t value) {
    if (value < 0) *this << "-";
    return *this << (value < 0 ? 0U - static_cast<std::uint32_t>(value) : static_cast<std::uint32_t>(value));
  }
  /// The bits of a double as 16 hexadecimal digits: nothing is lost on the way to the host.
  Line& operator<<(double value) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    char digits[17] = {};
    for (int i = 15; i >= 0; --i) {
      digits[i] = "0123456789abcdef"[bits & 15U];
      bits >>= 4;
    }
    return *this << digits;
  }

 private:
  static constexpr int capacity = 500;
  char text_[capacity + 2] = {};
  int used_ = 0;
};

}  // namespace firmware
