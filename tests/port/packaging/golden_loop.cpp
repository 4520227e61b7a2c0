// SPDX-License-Identifier: MIT
// golden_loop BLOB: the golden hashes, and what load() says of the blob in either precision. The blob comes from the host tool.
#include <cinttypes>
#include <cstdio>

#include "mdhcal.h"
#include "tests/lib/golden.hpp"

int main(int count, char** arguments) {
  using namespace mdhcal::test;
  static std::uint8_t bytes[mdhcal::blob_size];
  static mdhcal_calibrated_arm arm;
  static mdhcalf_calibrated_arm float_arm;
  std::FILE* file = count == 2 ? std::fopen(arguments[1], "rb") : nullptr;
  const std::size_t size = file != nullptr ? std::fread(bytes, 1, sizeof bytes, file) : 0;
  const bool same = golden_hash<double>(golden_operations) == golden_double &&
                    golden_hash<double>(golden_short) == golden_double_short &&
                    golden_hash<float>(golden_operations) == golden_float &&
                    golden_hash<float>(golden_short) == golden_float_short;
  std::printf("%s, double: %s, float: %s\n", same ? "golden" : "other bits",
              mdhcal_status_text(mdhcal_load(&arm, sizeof arm, MDHCAL_ABI_VERSION, bytes, size, nullptr)),
              mdhcal_status_text(mdhcalf_load(&float_arm, sizeof float_arm, MDHCAL_ABI_VERSION, bytes, size, nullptr)));
  return 0;
}
