// SPDX-License-Identifier: MIT
// Whether the units of a table's columns can be what they are taken for.
#pragma once

#include <string>
#include <vector>

#include "offline/import/meaning.hpp"
#include "offline/import/table.hpp"

namespace mdhcal::offline {

/// What has to be asked before the table's numbers are used: a column states a unit of another kind than what it measures, or
/// the joints may well be radians and nothing says so. Empty if nothing has to be.
std::string question_of_units(const std::vector<Meaning>& meanings, const TextTable& table, const Robot& robot, const Profile& profile);

}  // namespace mdhcal::offline
