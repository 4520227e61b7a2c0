// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

#include "mdhcal/blob.hpp"

namespace mdhcal::fuzz {

/// The first invariant of docs/security.md that an accepted blob breaks, by its name there, or null. `bytes` are the
/// blob's 8160 bytes, `model` what decode() made of them. `thorough` also runs the self-test, which takes longer.
const char* broken_invariant(const std::uint8_t* bytes, const BlobContent& model, bool thorough);

}  // namespace mdhcal::fuzz
