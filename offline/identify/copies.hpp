// SPDX-License-Identifier: MIT
// Rows that are bit-equal copies of others inform once.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "offline/measure/dataset.hpp"

namespace mdhcal::offline {

struct CountedOnce {
  Dataset data;                   ///< without the copies
  std::string note;               ///< a sentence, if there were any
  /// Targets of which every row is a copy of another target's: (its name, the name of the one that stays).
  std::vector<std::pair<std::string, std::string>> twins;
};

/// Leaves out every row that states the same readings and the same measurement, bit by bit, as one before it, whatever its
/// id, group or target. Rows that belong to a distance between poses stay.
CountedOnce count_once(const Dataset& data);

}  // namespace mdhcal::offline
