// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "offline/output/blob_writer.hpp"

namespace mdhcal::offline {

/// An Ed25519 key pair (RFC 8032). The secret is the seed of 32 bytes; whoever has it can sign blobs.
struct KeyPair {
  std::array<std::uint8_t, 32> secret{};
  std::array<std::uint8_t, 32> public_key{};
};

/// A new key pair from the system's random source.
KeyPair generate_key();

/// The key pair of a seed.
KeyPair key_of(const std::array<std::uint8_t, 32>& secret);

/// 32 bytes as a key file holds them, one line of 64 hexadecimal digits.
std::string key_text(const std::array<std::uint8_t, 32>& key);

/// A secret key as read from a file.
struct SecretKey {
  std::array<std::uint8_t, 32> seed{};
  bool open_to_others = false;  ///< somebody else than the file's owner may read it
};

/// Reads a key file. Throws InputError if it is anything but 64 hexadecimal digits and white space, or if its name ends in
/// that of the other kind of key (.pub, .key): both are 32 bytes, and nothing else tells one from the other.
SecretKey read_secret_key(const std::string& path);
std::array<std::uint8_t, 32> read_public_key(const std::string& path);

/// Signs a blob, in place of any signature that it has, and repairs the CRC. `counter`, if given, becomes the blob's
/// security counter. Ed25519 is deterministic: the same blob, key and counter give the same bytes.
void sign(Blob& blob, const KeyPair& key, const std::optional<std::uint32_t>& counter);

/// Whether the blob carries a signature that verifies under this public key.
bool signature_verifies(const Blob& blob, const std::array<std::uint8_t, 32>& public_key);

}  // namespace mdhcal::offline
