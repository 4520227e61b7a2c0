// SPDX-License-Identifier: MIT
// Private to lib/src. The blob's fields, read and judged one by one, and the model made of them.
#pragma once

#include "blob/little_endian.hpp"
#include "mdhcal/blob.hpp"

namespace mdhcal {

/// Whether `size` bytes are all zero.
bool all_zero(const std::uint8_t* p, std::size_t size) noexcept;

/// Whether a text field is well-formed: at least one zero byte, zeros only behind the first, no control characters,
/// UTF-8 (RFC 3629).
bool text_valid(const std::uint8_t* p, std::size_t size) noexcept;

template <class Real>
static inline Real load_real(const std::uint8_t* p) {
  if constexpr (sizeof(Real) == 8) {
    return load_f64(p);
  } else {
    return load_f32(p);
  }
}

/// One joint's five parameters; `which` is at::joint::nominal or at::joint::corrected.
Link load_link(const std::uint8_t* bytes, std::size_t joint, std::size_t which) noexcept;

/// The corrected geometry, whatever its values. The joint count must be valid.
void load_geometry(const std::uint8_t* bytes, Geometry& geometry) noexcept;

/// The transmission, whatever its values.
void load_transmission(const std::uint8_t* bytes, Transmission& transmission) noexcept;

/// The whole model of a blob that has passed every check.
void load_model(const std::uint8_t* bytes, BlobContent& model) noexcept;

}  // namespace mdhcal
