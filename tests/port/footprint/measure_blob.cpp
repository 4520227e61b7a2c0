// SPDX-License-Identifier: MIT
#include "mdhcal/port/store.hpp"
#include "meter.hpp"
#include "some_blob.hpp"

namespace footprint {

namespace {

using namespace mdhcal;

std::uint8_t blob[blob_size], buffer[blob_size], header[slot_header_size];
std::uint32_t number;
Status status;
const char* words;
BlobContent model;
SlotHeader decoded;
StoreState store_state;

// A flash in memory that does nothing but hold bytes: what is left is the store's own cost.
constexpr FlashGeometry flash_geometry{32, 8192, 2, 0xFF};
std::uint8_t flash_bytes[2 * 8192];

Status read_flash(void*, std::uint32_t address, std::uint8_t* to, std::uint32_t size) {
  std::copy_n(flash_bytes + address, size, to);
  return Status::ok;
}
Status program_flash(void*, std::uint32_t address, const std::uint8_t* granule) {
  std::copy_n(granule, flash_geometry.granule_bytes, flash_bytes + address);
  return Status::ok;
}
Status erase_flash(void*, std::uint32_t address) {
  std::fill_n(flash_bytes + address, flash_geometry.sector_bytes, flash_geometry.erased_value);
  return Status::ok;
}
constexpr Flash memory_flash{flash_geometry, read_flash, program_flash, erase_flash, nullptr};
constexpr Loader any_blob{[](const std::uint8_t*, std::size_t, void*) { return Status::ok; }, nullptr};

void expect(Status expected, const char* what) {
  if (status != expected) std::printf("%s: %s\n", what, status_text(status));
}

template <class Real>
void measure_self_test(int count) {
  measure("self_test", precision_name<Real>, "blobs", count,
          [](int i) {
            some_blob(static_cast<std::uint64_t>(i) + 1, true, blob);
            status = decode(blob, blob_size, DecodeOptions{}, model);
            status = make_arm(model.geometry, State<Real>::arm);
          },
          [] { status = self_test(model, State<Real>::arm); });
  expect(Status::self_test_tolerance, "self_test");
}

}  // namespace

void measure_blob() {
  constexpr int count = input_count;
  const auto another = [](int i) { some_blob(static_cast<std::uint64_t>(i) + 1, false, blob); };
  measure("status_text", "-", "any", 30, [](int i) { status = static_cast<Status>(i); }, [] { words = status_text(status); });
  measure("crc32", "-", "blobs", count, another, [] { number = crc32(blob, blob_size); });
  measure("decode", "-", "blobs", count, another, [] { status = decode(blob, blob_size, DecodeOptions{}, model); });
  expect(Status::ok, "decode");
  measure_self_test<double>(tick_count<double>);
  measure_self_test<float>(tick_count<double>);  // the blobs hold vectors in double too

  const auto next = [](int i) { decoded = {static_cast<std::uint32_t>(i) * 2654435761U, ~static_cast<std::uint32_t>(i)}; };
  measure("encode_slot_header", "-", "any", input_count, next, [] { encode_slot_header(decoded, header); });
  measure("decode_slot_header", "-", "any", input_count,
          [&](int i) {
            next(i);
            encode_slot_header(decoded, header);
          },
          [] { status = decode_slot_header(header, decoded); });
  expect(Status::ok, "decode_slot_header");
  measure("slot_bytes", "-", "any", input_count, [](int) {}, [] { number = slot_bytes(memory_flash.geometry); });
  std::fill(std::begin(flash_bytes), std::end(flash_bytes), flash_geometry.erased_value);
  store_state = {1, -1, 0, {Status::ok, Status::ok}};
  measure("update", "-", "blobs", count, another,
          [] { status = update(memory_flash, any_blob, blob, blob_size, store_state); });
  expect(Status::ok, "update");
  measure("load_newest", "-", "blobs", count,
          [&](int i) {
            another(i);
            status = update(memory_flash, any_blob, blob, blob_size, store_state);
          },
          [] { status = load_newest(memory_flash, any_blob, buffer, store_state); });
  expect(Status::ok, "load_newest");
}

}  // namespace footprint
