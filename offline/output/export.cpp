// SPDX-License-Identifier: MIT
#include "offline/output/export.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <vector>

#include "offline/base/error.hpp"

namespace mdhcal::offline {

namespace {

constexpr std::size_t bytes_per_record = 16;

void append_hex(std::string& text, std::uint8_t byte) {
  constexpr char digits[] = "0123456789ABCDEF";
  text += digits[byte >> 4];
  text += digits[byte & 15];
}

void check_fit(std::size_t size, std::uint64_t address) {
  constexpr std::uint64_t end = std::uint64_t{1} << 32;
  if (address > end || size > end - address) {
    throw InputError("The image of " + std::to_string(size) + " bytes does not fit below 2^32 at address " +
                     std::to_string(address) + ", expected a 32-bit address.");
  }
}

std::uint8_t octet(std::uint64_t value, unsigned index) { return static_cast<std::uint8_t>(value >> (8 * index)); }

// One record: a lead, then the fields in hexadecimal, then a checksum over them.
std::string record(const std::string& lead, const std::vector<std::uint8_t>& fields, bool twos_complement) {
  std::string text = lead;
  std::uint8_t sum = 0;
  for (const std::uint8_t byte : fields) {
    append_hex(text, byte);
    sum = static_cast<std::uint8_t>(sum + byte);
  }
  append_hex(text, static_cast<std::uint8_t>(twos_complement ? -sum : ~sum));
  return text + '\n';
}

std::string hex_record(std::uint16_t address, std::uint8_t type, std::span<const std::uint8_t> data) {
  std::vector<std::uint8_t> fields{static_cast<std::uint8_t>(data.size()), octet(address, 1), octet(address, 0), type};
  fields.insert(fields.end(), data.begin(), data.end());
  return record(":", fields, true);
}

std::string motorola_record(char type, unsigned address_bytes, std::uint64_t address, std::span<const std::uint8_t> data) {
  std::vector<std::uint8_t> fields{static_cast<std::uint8_t>(address_bytes + data.size() + 1)};
  for (unsigned i = address_bytes; i > 0; --i) fields.push_back(octet(address, i - 1));
  fields.insert(fields.end(), data.begin(), data.end());
  return record(std::string("S") + type, fields, false);
}

bool is_identifier(const std::string& name) {
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  return !name.empty() && letter(name[0]) &&
         std::all_of(name.begin(), name.end(), [&](char c) { return letter(c) || digit(c); });
}

}  // namespace

std::string intel_hex(std::span<const std::uint8_t> bytes, std::uint64_t address) {
  check_fit(bytes.size(), address);
  std::string text;
  std::uint64_t upper = 0;  // what a reader assumes at the start
  for (std::size_t done = 0; done < bytes.size();) {
    const std::uint64_t at = address + done;
    if (at >> 16 != upper) {
      upper = at >> 16;
      text += hex_record(0, 4, std::array{octet(upper, 1), octet(upper, 0)});
    }
    const std::size_t to_boundary = 0x10000 - (at & 0xFFFF);  // a record does not cross a 64 KiB boundary
    const std::size_t count = std::min({bytes_per_record, bytes.size() - done, to_boundary});
    text += hex_record(static_cast<std::uint16_t>(at & 0xFFFF), 0, bytes.subspan(done, count));
    done += count;
  }
  return text + hex_record(0, 1, {});
}

std::string s_record(std::span<const std::uint8_t> bytes, std::uint64_t address) {
  check_fit(bytes.size(), address);
  constexpr std::array<std::uint8_t, 6> header{'m', 'd', 'h', 'c', 'a', 'l'};
  std::string text = motorola_record('0', 2, 0, header);
  std::size_t records = 0;
  for (std::size_t done = 0; done < bytes.size(); ++records) {
    const std::size_t count = std::min(bytes_per_record, bytes.size() - done);
    text += motorola_record('3', 4, address + done, bytes.subspan(done, count));
    done += count;
  }
  return text + motorola_record('5', 2, records, {}) + motorola_record('7', 4, 0, {});
}

std::string c_array(std::span<const std::uint8_t> bytes, const std::string& name) {
  if (!is_identifier(name)) {
    throw InputError("The symbol is '" + name + "', expected a C identifier of letters, digits and underscores.");
  }
  const std::string declaration = "const unsigned char " + name + "[" + std::to_string(bytes.size()) + "]";
  std::string text = "/* Parameter blob, written by mdhcal. */\n#ifdef __cplusplus\nextern \"C\" " + declaration +
                     ";\n#endif\n" + declaration + " = {";
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    text += i % bytes_per_record == 0 ? "\n    0x" : " 0x";
    append_hex(text, bytes[i]);
    text += ',';
  }
  return text + "\n};\n";
}

}  // namespace mdhcal::offline
