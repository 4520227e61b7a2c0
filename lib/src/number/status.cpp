// SPDX-License-Identifier: MIT
#include "mdhcal/status.hpp"

namespace mdhcal {

const char* status_text(Status status) noexcept {
  switch (status) {
    case Status::ok: return "ok";
    case Status::step_limited: return "limited by the step";
    case Status::joint_limited: return "limited by a joint limit";
    case Status::near_singular: return "near singular";
    case Status::out_of_reach: return "out of reach";
    case Status::not_converged: return "not converged within the iteration bound";
    case Status::bad_input: return "bad input";
    case Status::bad_environment: return "floating-point environment is not IEEE default";
    case Status::blob_magic: return "not a parameter blob";
    case Status::blob_version: return "unknown format version";
    case Status::blob_size: return "wrong size";
    case Status::blob_layout: return "wrong layout id";
    case Status::blob_crc: return "CRC-32 mismatch";
    case Status::blob_serial: return "made for another robot";
    case Status::blob_value: return "a value is not finite or out of range";
    case Status::blob_reserved: return "a reserved byte is not zero";
    case Status::blob_deviation: return "calibration deviates too far from nominal";
    case Status::blob_unsigned: return "not signed";
    case Status::blob_signature: return "signature does not verify";
    case Status::blob_counter: return "security counter is too low";
    case Status::self_test_failed: return "self-test failed";
    case Status::self_test_tolerance: return "self-test passed within tolerance, other arithmetic";
    case Status::flash_read: return "flash read failed";
    case Status::flash_program: return "flash program failed";
    case Status::flash_erase: return "flash erase failed";
    case Status::flash_verify: return "flash read-back differs";
    case Status::flash_geometry: return "unusable flash geometry";
    case Status::store_empty: return "no acceptable blob stored";
    case Status::store_unreadable: return "a slot of the store cannot be read";
  }
  return "unknown status";
}

}  // namespace mdhcal
