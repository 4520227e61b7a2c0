// SPDX-License-Identifier: MIT
// The measured sets that results are held against, read from the shared data.
#pragma once

#include <string>

#include "offline/measure/dataset.hpp"
#include "offline/robot/robot.hpp"

namespace mdhcal::tests {

/// The robot of (Li 2022, Table 1), as a robot file.
std::string li2022_robot_text();
offline::Robot li2022_robot();

/// Tables 3 (nine poses) and 8 (eighteen) of (Li 2022): measured positions.
offline::Dataset li2022_nine();
offline::Dataset li2022_eighteen();
/// All 27 of them; ids of the eighteen start with "t8-".
offline::Dataset li2022_all();

/// The rows of a dataset for which `keep(index)` holds; groups are numbered anew.
template <class Keep>
offline::Dataset rows_where(const offline::Dataset& data, Keep keep);

/// A dataset with another's rows behind its own, ids prefixed.
offline::Dataset joined(const offline::Dataset& a, const offline::Dataset& b, const std::string& prefix);

template <class Keep>
offline::Dataset rows_where(const offline::Dataset& data, Keep keep) {
  offline::Dataset out = data;
  out.rows.clear();
  for (std::size_t i = 0; i < data.rows.size(); ++i) {
    if (keep(i)) out.rows.push_back(data.rows[i]);
  }
  return out;
}

}  // namespace mdhcal::tests
