// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "mdhcal/blob.hpp"

namespace firmware {

/// Takes frames off the byte channel: "MDHU", the size as four bytes, little-endian, and so many bytes of a blob; or
/// "MDHQ", the end. Bytes that begin no frame are passed over. The blob's own CRC-32 guards the content.
class Receiver {
 public:
  enum class Event : std::int32_t { none, blob, bad_size, abandoned, quit };

  Event take(std::uint8_t byte, std::uint32_t now_ms);
  /// To be called often: gives up a frame that has stopped for `timeout_ms`.
  Event idle(std::uint32_t now_ms);

  const std::uint8_t* blob() const { return blob_; }
  std::uint32_t received() const { return received_; }

 private:
  static constexpr std::uint32_t timeout_ms = 500;
  static constexpr std::uint32_t head_bytes = 8;

  std::uint8_t head_[head_bytes] = {};
  std::uint8_t blob_[mdhcal::blob_size] = {};
  std::uint32_t head_size_ = 0;
  std::uint32_t received_ = 0;
  std::uint32_t last_ms_ = 0;
};

}  // namespace firmware
