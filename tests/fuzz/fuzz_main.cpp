// SPDX-License-Identifier: MIT
// libFuzzer's entry for the target that MDHCAL_FUZZ_TARGET names.
#include "tests/fuzz/targets.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  mdhcal::fuzz::MDHCAL_FUZZ_TARGET(data, size);
  return 0;
}
