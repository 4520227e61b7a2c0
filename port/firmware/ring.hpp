// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <cstdint>

namespace firmware {

/// Bytes from one interrupt to the background. What does not fit is lost: the blob's CRC-32 will tell.
class Ring {
 public:
  void put(std::uint8_t byte) {
    const std::uint32_t head = head_.load();
    if (head - tail_.load() == size) return;
    bytes_[head % size] = byte;
    head_.store(head + 1U);
  }
  bool take(std::uint8_t& byte) {
    const std::uint32_t tail = tail_.load();
    if (tail == head_.load()) return false;
    byte = bytes_[tail % size];
    tail_.store(tail + 1U);
    return true;
  }

 private:
  static constexpr std::uint32_t size = 8192;
  std::uint8_t bytes_[size] = {};
  std::atomic<std::uint32_t> head_{0}, tail_{0};
};

}  // namespace firmware
