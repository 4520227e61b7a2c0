// SPDX-License-Identifier: MIT
// What decoding costs on a Cortex-M7: the fullest blob there is, CRC and all checks, at most 120 000 instructions. Run
// under QEMU with -icount (tests/port/footprint/counter.hpp).
#include <cstdio>

#include "golden_blobs.hpp"
#include "mdhcal/blob.hpp"
#include "mdhcal/crc32.hpp"
#include "tests/port/footprint/counter.hpp"

namespace {

mdhcal::BlobContent model;
mdhcal::Status status;
std::uint32_t crc;

}  // namespace

int main() {
  using namespace mdhcal;
  footprint::start_counter();
  const std::uint32_t crc_cost =
      footprint::raw_instructions([] { crc = crc32(golden::every_field, blob_layout::crc); });
  const std::uint32_t decode_cost =
      footprint::raw_instructions([] { status = decode(golden::every_field, blob_size, DecodeOptions{}, model); });
  std::printf("decode: %u instructions, of which CRC-32 %u; bound 120000\n", static_cast<unsigned>(decode_cost),
              static_cast<unsigned>(crc_cost));
  return status == Status::ok && decode_cost > crc_cost && decode_cost <= 120000 ? 0 : 1;
}
