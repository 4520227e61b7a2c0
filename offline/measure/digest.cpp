// SPDX-License-Identifier: MIT
#include "offline/measure/digest.hpp"

#include <sodium.h>

#include <array>

namespace mdhcal::offline {

std::string sha256_hex(std::string_view bytes) {
  std::array<unsigned char, crypto_hash_sha256_BYTES> hash{};
  // The cast only changes the sign of the bytes; libsodium takes them unsigned.
  crypto_hash_sha256(hash.data(), reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
  std::string hex;
  for (const unsigned char byte : hash) {
    hex += "0123456789abcdef"[byte >> 4U];
    hex += "0123456789abcdef"[byte & 15U];
  }
  return hex;
}

}  // namespace mdhcal::offline
