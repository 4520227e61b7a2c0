// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "mdhcal/blob.hpp"

namespace mdhcal {

/// An Ed25519 public key, as `mdhcal keygen` writes it.
struct SodiumKey {
  std::uint8_t public_key[32];
};

/// A verifier for decode() on a host or a controller with libsodium: call sodium_init() once before. `key` must outlive
/// its use. Library mdhcal::port_sodium.
Verifier sodium_verifier(SodiumKey& key) noexcept;

}  // namespace mdhcal
