// SPDX-License-Identifier: MIT
#include "mdhcal/port/sodium_verifier.hpp"

#include <sodium.h>

namespace mdhcal {

namespace {

bool verify(const std::uint8_t* message, std::size_t size, const std::uint8_t* signature, void* context) {
  const auto* key = static_cast<const SodiumKey*>(context);
  return crypto_sign_verify_detached(signature, message, size, key->public_key) == 0;
}

}  // namespace

Verifier sodium_verifier(SodiumKey& key) noexcept { return {verify, &key}; }

}  // namespace mdhcal
