// SPDX-License-Identifier: MIT
#include "mdhcal/calibrated_arm.hpp"

namespace mdhcal {

const Target* find_target(const BlobDescription& description, const char* name) noexcept {
  if (name == nullptr) return nullptr;
  for (std::int32_t k = 0; k < description.target_count && k < static_cast<std::int32_t>(max_targets); ++k) {
    const char* own = description.target[k].name;
    std::size_t i = 0;
    while (i < blob_layout::target_name_size && own[i] == name[i] && own[i] != '\0') ++i;
    if (i < blob_layout::target_name_size && own[i] == name[i]) return &description.target[k];
  }
  return nullptr;
}

}  // namespace mdhcal
