// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>

namespace mdhcal::offline {

/// SHA-256 of the bytes, in lower-case hexadecimal.
std::string sha256_hex(std::string_view bytes);

}  // namespace mdhcal::offline
