// SPDX-License-Identifier: MIT
#pragma once

#include "mdhcal/arm.hpp"
#include "mdhcal/blob.hpp"
#include "mdhcal/status.hpp"

namespace mdhcal {

/// Names the arithmetic of this library's forward() and tick(): two libraries with the same number give the same bits.
/// It changes with every change of the source after which one of the two gives other bits.
inline constexpr std::uint32_t arithmetic_id = 9;

/// How far the results may be from the vectors of a blob with another arithmetic id [m] and [rad].
inline constexpr double self_test_bound = 1e-9;
inline constexpr float self_test_bound_float = 1e-5F;

/// From vector readings to the seed of its inverse: + for joints 0, 2, ..., - for joints 1, 3, ... [rad] or [m].
inline constexpr double self_test_offset = 0.015625;

/// Runs the blob's self-test vectors (docs/blob.md) of the arm's precision on this machine: forward() at each vector's
/// readings, and tick() from the perturbed seed. `arm` is the model's own, from make_arm(model.geometry, arm). Takes the
/// time of a few ticks: once, outside the servo loop.
/// Returns ok (every bit is the host's), self_test_tolerance (the blob names another arithmetic id, and all is within
/// the tolerance), self_test_failed (a vector is missed, or the blob holds none of this precision).
Status self_test(const BlobContent& model, const Arm<double>& arm) noexcept;
Status self_test(const BlobContent& model, const Arm<float>& arm) noexcept;

}  // namespace mdhcal
