// SPDX-License-Identifier: MIT
#include "receiver.hpp"

namespace firmware {

Receiver::Event Receiver::take(std::uint8_t byte, std::uint32_t now_ms) {
  last_ms_ = now_ms;
  if (head_size_ == head_bytes) {
    blob_[received_++] = byte;
    if (received_ < mdhcal::blob_size) return Event::none;
    head_size_ = 0;
    return Event::blob;
  }
  constexpr char magic[4] = "MDH";
  if (head_size_ < 3 && byte != static_cast<std::uint8_t>(magic[head_size_])) {
    head_size_ = byte == static_cast<std::uint8_t>(magic[0]) ? 1 : 0;
    return Event::none;
  }
  head_[head_size_++] = byte;
  if (head_size_ == 4 && byte != 'U') {
    head_size_ = 0;
    return byte == 'Q' ? Event::quit : Event::none;
  }
  if (head_size_ < head_bytes) return Event::none;
  received_ = 0;
  std::uint32_t size = 0;
  for (std::uint32_t i = 0; i < 4; ++i) size |= static_cast<std::uint32_t>(head_[4 + i]) << (8 * i);
  if (size == mdhcal::blob_size) return Event::none;
  head_size_ = 0;
  return Event::bad_size;
}

Receiver::Event Receiver::idle(std::uint32_t now_ms) {
  if (head_size_ == 0 || now_ms - last_ms_ < timeout_ms) return Event::none;
  head_size_ = 0;
  return Event::abandoned;
}

}  // namespace firmware
