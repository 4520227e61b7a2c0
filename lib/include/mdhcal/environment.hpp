// SPDX-License-Identifier: MIT
#pragma once

#include "mdhcal/status.hpp"

namespace mdhcal {

/// Looks, by computing, whether the processor keeps subnormal numbers and rounds to nearest, in both precisions: what
/// the same bits on every machine rest on. Call it at start-up and in each thread or task that calls the library
/// (FPSCR, MXCSR and FPCR belong to the thread). Returns ok or bad_environment.
Status check_environment() noexcept;

}  // namespace mdhcal
