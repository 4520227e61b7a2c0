// SPDX-License-Identifier: MIT
// A flash in memory that is stricter than hardware, and whose power can be cut at any operation.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <vector>

#include "mdhcal/port/flash.hpp"

namespace mdhcal::test {

/// What a power cut leaves of the operation that it meets.
enum class Torn : std::int32_t {
  untouched,  ///< the power went before it began
  finished,   ///< the power went after its end
  half,       ///< its first half is done
  bits,       ///< every bit is done or not, at random
  ecc,        ///< the granules that it touched cannot be read
};
inline constexpr std::array<Torn, 5> torn_modes{Torn::untouched, Torn::finished, Torn::half, Torn::bits, Torn::ecc};

/// One region of flash. A granule is programmed once between two erases; an unaligned, outlying or repeated operation
/// is refused and counted in `violations`.
class FakeFlash {
 public:
  explicit FakeFlash(const FlashGeometry& geometry)
      : flash{geometry, read, program, erase, this},
        bytes(static_cast<std::size_t>(geometry.sector_bytes) * geometry.sector_count, geometry.erased_value),
        granules(bytes.size() / geometry.granule_bytes, Granule::erased) {}
  FakeFlash(const FakeFlash& other) : FakeFlash(other.flash.geometry) { restore(other); }
  FakeFlash& operator=(const FakeFlash&) = delete;

  /// Takes over another's content, powered and counting from zero.
  void restore(const FakeFlash& other) {
    std::memcpy(bytes.data(), other.bytes.data(), bytes.size());
    std::memcpy(granules.data(), other.granules.data(), granules.size() * sizeof(Granule));
    power_up();
  }

  /// Cuts the power at the operation with this number, counted from 0 (reads count).
  void cut_at(int operation, Torn mode) {
    cut_operation = operation;
    cut_mode = mode;
  }

  /// Lets one operation fail, power on: it is not done and says so.
  void fail_at(int operation) { failing_operation = operation; }

  /// Lets the reads fail that are among the operations `from` to `until` - 1 and touch a byte of [begin, end), power on.
  void fail_reads(int from, int until, std::uint32_t begin = 0, std::uint32_t end = 0xFFFFFFFFU) {
    deaf = {from, until, begin, end};
  }

  void power_up() {
    operations = 0;
    cut_operation = -1;
    failing_operation = -1;
    deaf = {0, 0, 0, 0};
    powered = true;
    cut_met_a_read = false;
    failed_reads = 0;
  }

  Flash flash;
  std::vector<std::uint8_t> bytes;
  int operations = 0;
  int violations = 0;
  bool powered = true;
  bool cut_met_a_read = false;
  int failed_reads = 0;  ///< by fail_reads()
  bool readable = true;  ///< false: every read fails, like a part that has gone

 private:
  enum class Granule : std::uint8_t { erased, programmed, ecc };

  static FakeFlash& self(void* context) { return *static_cast<FakeFlash*>(context); }

  // Whether the operation goes through, is torn, or does nothing.
  enum class Course { whole, torn, none };
  Course begin() {
    if (!powered) return Course::none;
    const int number = operations++;
    if (number == failing_operation) return Course::none;
    if (number != cut_operation) return Course::whole;
    powered = false;
    return Course::torn;
  }

  std::uint32_t random() {
    seed ^= seed << 13;
    seed ^= seed >> 17;
    seed ^= seed << 5;
    return seed;
  }

  bool inside(std::uint32_t address, std::uint32_t size) const {
    return size <= bytes.size() && address <= bytes.size() - size;
  }

  // Brings the range from what it holds to `wanted` as far as the mode lets it.
  void tear(std::uint32_t address, const std::uint8_t* wanted, std::uint32_t size, Granule after) {
    if (cut_mode == Torn::untouched) return;
    const std::uint32_t granule = flash.geometry.granule_bytes;
    const std::uint32_t reached = cut_mode == Torn::half ? size / 2 : size;
    for (std::uint32_t i = 0; i < reached; ++i) {
      std::uint8_t& byte = bytes[address + i];
      const auto mask = static_cast<std::uint8_t>(cut_mode == Torn::bits ? random() : 0xFFU);
      byte = static_cast<std::uint8_t>((byte & ~mask) | (wanted[i] & mask));
    }
    // What was cut in the middle is not erased: it must not be programmed before the next erase.
    const Granule state = cut_mode == Torn::ecc ? Granule::ecc : cut_mode == Torn::finished ? after : Granule::programmed;
    for (std::uint32_t i = 0; i < size; i += granule) granules[(address + i) / granule] = state;
  }

  static Status read(void* context, std::uint32_t address, std::uint8_t* to, std::uint32_t size) {
    FakeFlash& fake = self(context);
    const bool deaf = fake.operations >= fake.deaf.from && fake.operations < fake.deaf.until &&
                      address < fake.deaf.end && address + size > fake.deaf.begin;
    const Course course = fake.begin();
    if (course == Course::torn) fake.cut_met_a_read = true;
    if (deaf) ++fake.failed_reads;
    if (course != Course::whole || deaf || !fake.readable) return Status::flash_read;
    if (!fake.inside(address, size)) {
      ++fake.violations;
      return Status::flash_read;
    }
    const std::uint32_t granule = fake.flash.geometry.granule_bytes;
    for (std::uint32_t i = address / granule; i * granule < address + size; ++i) {
      if (fake.granules[i] == Granule::ecc) return Status::flash_read;
    }
    std::memcpy(to, fake.bytes.data() + address, size);
    return Status::ok;
  }

  static Status program(void* context, std::uint32_t address, const std::uint8_t* from) {
    FakeFlash& fake = self(context);
    const std::uint32_t granule = fake.flash.geometry.granule_bytes;
    if (!fake.powered) return Status::flash_program;
    if (address % granule != 0 || !fake.inside(address, granule) || fake.granules[address / granule] != Granule::erased) {
      ++fake.violations;
      return Status::flash_program;
    }
    const Course course = fake.begin();
    if (course == Course::torn) fake.tear(address, from, granule, Granule::programmed);
    if (course != Course::whole) return Status::flash_program;
    std::memcpy(fake.bytes.data() + address, from, granule);
    fake.granules[address / granule] = Granule::programmed;
    return Status::ok;
  }

  static Status erase(void* context, std::uint32_t address) {
    FakeFlash& fake = self(context);
    const FlashGeometry& geometry = fake.flash.geometry;
    if (!fake.powered) return Status::flash_erase;
    if (address % geometry.sector_bytes != 0 || !fake.inside(address, geometry.sector_bytes)) {
      ++fake.violations;
      return Status::flash_erase;
    }
    const Course course = fake.begin();
    if (course == Course::torn) {
      const std::vector<std::uint8_t> erased(geometry.sector_bytes, geometry.erased_value);
      fake.tear(address, erased.data(), geometry.sector_bytes, Granule::erased);
    }
    if (course != Course::whole) return Status::flash_erase;
    std::memset(fake.bytes.data() + address, geometry.erased_value, geometry.sector_bytes);
    for (std::uint32_t i = 0; i < geometry.sector_bytes; i += geometry.granule_bytes) {
      fake.granules[(address + i) / geometry.granule_bytes] = Granule::erased;
    }
    return Status::ok;
  }

  std::vector<Granule> granules;
  int cut_operation = -1;
  int failing_operation = -1;
  struct {
    int from, until;
    std::uint32_t begin, end;
  } deaf = {0, 0, 0, 0};
  Torn cut_mode = Torn::untouched;
  std::uint32_t seed = 2463534242U;
};

}  // namespace mdhcal::test
