// SPDX-License-Identifier: MIT
#include "mdhcal/crc32.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace mdhcal {
namespace {

const std::uint8_t* bytes_of(const char* text) { return reinterpret_cast<const std::uint8_t*>(text); }

// Another derivation: polynomial division, a bit at a time.
std::uint32_t by_division(const std::vector<std::uint8_t>& bytes) {
  std::uint32_t crc = 0xFFFFFFFFU;
  for (const std::uint8_t byte : bytes) {
    for (unsigned bit = 0; bit < 8; ++bit) {
      const std::uint32_t carry = (crc ^ (byte >> bit)) & 1U;
      crc = (crc >> 1U) ^ (carry != 0U ? 0xEDB88320U : 0U);
    }
  }
  return crc ^ 0xFFFFFFFFU;
}

TEST(Crc32, HasThePublishedCheckValue) {
  EXPECT_EQ(crc32(bytes_of("123456789"), 9), 0xCBF43926U);
  EXPECT_EQ(crc32(nullptr, 0), 0U);
}

TEST(Crc32, IsPolynomialDivisionAtEverySizeAndAlignment) {
  std::mt19937_64 random(1);
  std::vector<std::uint8_t> bytes(80);
  for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random());
  for (std::size_t start = 0; start < 8; ++start) {
    for (std::size_t size = 0; start + size <= bytes.size(); ++size) {
      const std::vector<std::uint8_t> part(bytes.begin() + static_cast<std::ptrdiff_t>(start),
                                           bytes.begin() + static_cast<std::ptrdiff_t>(start + size));
      EXPECT_EQ(crc32(bytes.data() + start, size), by_division(part)) << start << ' ' << size;
    }
  }
}

TEST(Crc32, ContinuesAcrossParts) {
  const std::uint8_t* text = bytes_of("continued across parts");
  for (std::size_t cut = 0; cut <= 22; ++cut) {
    EXPECT_EQ(crc32(text + cut, 22 - cut, crc32(text, cut)), crc32(text, 22));
  }
}

}  // namespace
}  // namespace mdhcal
