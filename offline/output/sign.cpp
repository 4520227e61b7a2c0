// SPDX-License-Identifier: MIT
#include "offline/output/sign.hpp"

#include <algorithm>
#include <sodium.h>
#include <stdexcept>
#include <sys/stat.h>

#include "mdhcal/crc32.hpp"
#include "offline/base/error.hpp"
#include "offline/base/read_file.hpp"

namespace mdhcal::offline {

namespace at = blob_layout;

namespace {

static_assert(crypto_sign_SEEDBYTES == 32 && crypto_sign_PUBLICKEYBYTES == 32 && crypto_sign_BYTES == at::signature_size);

void start_sodium() {
  if (sodium_init() < 0) throw std::runtime_error("libsodium does not start: it finds no source of randomness.");
}

void put_u32(Blob& blob, std::size_t offset, std::uint32_t value) {
  for (std::size_t k = 0; k < 4; ++k) blob.at(offset + k) = static_cast<std::uint8_t>(value >> (8 * k));
}

}  // namespace

KeyPair generate_key() {
  start_sodium();
  std::array<std::uint8_t, 32> secret{};
  randombytes_buf(secret.data(), secret.size());
  return key_of(secret);
}

KeyPair key_of(const std::array<std::uint8_t, 32>& secret) {
  start_sodium();
  KeyPair key;
  key.secret = secret;
  std::array<std::uint8_t, crypto_sign_SECRETKEYBYTES> expanded{};
  crypto_sign_seed_keypair(key.public_key.data(), expanded.data(), secret.data());
  sodium_memzero(expanded.data(), expanded.size());
  return key;
}

std::string key_text(const std::array<std::uint8_t, 32>& key) {
  std::string text;
  for (const std::uint8_t byte : key) {
    text += "0123456789abcdef"[byte >> 4];
    text += "0123456789abcdef"[byte & 15];
  }
  return text + '\n';
}

namespace {

std::array<std::uint8_t, 32> read_key(const std::string& path) {
  const std::string text = read_file(path, "a key file", 4096);
  std::array<std::uint8_t, 32> key{};
  std::size_t size = 0;
  start_sodium();
  const int status =
      sodium_hex2bin(key.data(), key.size(), text.data(), text.size(), " \t\r\n", &size, nullptr);
  if (status != 0 || size != key.size()) {
    throw InputError(path, 1, 1, "This is not a key, expected one line of 64 hexadecimal digits.");
  }
  return key;
}

}  // namespace

SecretKey read_secret_key(const std::string& path) {
  if (path.ends_with(".pub")) {
    throw InputError(path, 0, 0, "The name is that of a public key; expected the secret one, NAME.key of mdhcal keygen.");
  }
  SecretKey key;
  key.seed = read_key(path);
  struct stat file = {};
  key.open_to_others = stat(path.c_str(), &file) == 0 && S_ISREG(file.st_mode) && (file.st_mode & (S_IRGRP | S_IROTH)) != 0;
  return key;
}

std::array<std::uint8_t, 32> read_public_key(const std::string& path) {
  if (path.ends_with(".key")) {
    throw InputError(path, 0, 0, "The name is that of a secret key; expected the public one, NAME.pub of mdhcal keygen.");
  }
  return read_key(path);
}

void sign(Blob& blob, const KeyPair& key, const std::optional<std::uint32_t>& counter) {
  start_sodium();
  if (counter) put_u32(blob, at::security_counter, *counter);
  std::fill(blob.begin() + at::authentication, blob.end(), std::uint8_t{0});
  put_u32(blob, at::algorithm, at::algorithm_ed25519);
  std::copy_n(key.public_key.begin(), at::key_id_size, blob.begin() + at::key_id);
  std::array<std::uint8_t, crypto_sign_SECRETKEYBYTES> expanded{};
  std::array<std::uint8_t, crypto_sign_PUBLICKEYBYTES> public_key{};
  crypto_sign_seed_keypair(public_key.data(), expanded.data(), key.secret.data());
  crypto_sign_detached(blob.data() + at::signature, nullptr, blob.data(), at::authentication, expanded.data());
  sodium_memzero(expanded.data(), expanded.size());
  put_u32(blob, at::crc, crc32(blob.data(), at::crc));
}

bool signature_verifies(const Blob& blob, const std::array<std::uint8_t, 32>& public_key) {
  start_sodium();
  return blob[at::algorithm] == at::algorithm_ed25519 && blob[at::algorithm + 1] == 0 && blob[at::algorithm + 2] == 0 &&
         blob[at::algorithm + 3] == 0 &&
         crypto_sign_verify_detached(blob.data() + at::signature, blob.data(), at::authentication, public_key.data()) == 0;
}

}  // namespace mdhcal::offline
