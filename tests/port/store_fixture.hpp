// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <cstring>

#include "fake_flash.hpp"
#include "mdhcal/crc32.hpp"
#include "mdhcal/port/store.hpp"

namespace mdhcal::test {

using Blob = std::array<std::uint8_t, blob_size>;

/// Bytes with a valid CRC-32, different for every number. The store does not look further; a real loader does.
inline Blob blob_of(std::uint32_t number) {
  Blob blob{};
  std::uint32_t state = number * 2654435761U + 1U;
  for (std::uint8_t& byte : blob) {
    state = state * 1664525U + 1013904223U;
    byte = static_cast<std::uint8_t>(state >> 24);
  }
  const std::uint32_t crc = crc32(blob.data(), blob.size() - 4);
  for (std::size_t i = 0; i < 4; ++i) blob[blob.size() - 4 + i] = static_cast<std::uint8_t>(crc >> (8 * i));
  return blob;
}

/// Accepts every blob but one, and keeps what it took last.
struct TestLoader {
  Loader loader{load, this};
  Blob taken{};
  int asked = 0;
  const Blob* refused = nullptr;

  TestLoader() = default;
  TestLoader(const TestLoader&) = delete;
  TestLoader& operator=(const TestLoader&) = delete;

 private:
  static Status load(const std::uint8_t* blob, std::size_t size, void* context) {
    TestLoader& self = *static_cast<TestLoader*>(context);
    ++self.asked;
    if (self.refused != nullptr && std::memcmp(self.refused->data(), blob, size) == 0) return Status::blob_serial;
    std::memcpy(self.taken.data(), blob, size);
    return Status::ok;
  }
};

/// A store as a controller starts it.
struct TestStore {
  explicit TestStore(FakeFlash& flash) : fake(flash) {}
  Status start() { return load_newest(fake.flash, loader.loader, buffer, state); }
  Status put(const Blob& blob) { return update(fake.flash, loader.loader, blob.data(), blob.size(), state); }

  FakeFlash& fake;
  TestLoader loader;
  StoreState state{};
  std::uint8_t buffer[blob_size]{};
};

/// Programs a factory image: header and blob, in a slot.
inline Status flash_factory(FakeFlash& fake, std::uint32_t slot, std::uint32_t sequence, const Blob& blob) {
  const FlashGeometry& geometry = fake.flash.geometry;
  std::vector<std::uint8_t> image(slot_bytes(geometry), geometry.erased_value);
  std::uint32_t crc = 0;
  for (std::size_t i = 0; i < 4; ++i) crc |= static_cast<std::uint32_t>(blob[blob.size() - 4 + i]) << (8 * i);
  encode_slot_header({sequence, crc}, image.data());
  std::memcpy(image.data() + slot_header_size, blob.data(), blob.size());
  for (std::uint32_t at = 0; at < slot_header_size + blob.size(); at += geometry.granule_bytes) {
    const Status status = fake.flash.program(&fake, slot * slot_bytes(geometry) + at, image.data() + at);
    if (status != Status::ok) return status;
  }
  return Status::ok;
}

}  // namespace mdhcal::test
