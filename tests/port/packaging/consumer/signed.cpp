// SPDX-License-Identifier: MIT
// A program of somebody else that looks at signatures: of nothing by a key of zeros, there is none.
#include <mdhcal/port/sodium_verifier.hpp>

int main() {
  mdhcal::SodiumKey key = {};
  const mdhcal::Verifier verifier = mdhcal::sodium_verifier(key);
  const std::uint8_t message[4] = {}, signature[64] = {1};
  return verifier.verify(message, sizeof message, signature, verifier.context) ? 1 : 0;
}
