// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace mdhcal::offline {

/// Intel HEX: records of 16 data bytes, extended linear address records (type 04) wherever the upper 16 bits of the
/// address change, the end record. Throws InputError if the image does not fit below 2^32.
std::string intel_hex(std::span<const std::uint8_t> bytes, std::uint64_t address);

/// Motorola S-records: a header, 32-bit data records (S3) of 16 bytes, the record count, the end record (S7) with
/// entry address 0. Throws InputError likewise.
std::string s_record(std::span<const std::uint8_t> bytes, std::uint64_t address);

/// A constant array for C99 and C++, aligned by its user's linker script or attribute. Throws InputError if `name` is
/// not an identifier.
std::string c_array(std::span<const std::uint8_t> bytes, const std::string& name);

}  // namespace mdhcal::offline
