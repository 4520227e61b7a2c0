// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "offline/filter/target_text.hpp"

namespace mdhcal::offline {

/// How many digits behind the point a number as written states; an exponent counts. At most 15.
int decimals_of(std::string_view number);

/// The number with so many digits behind the point, never "-0".
std::string with_decimals(double value, int decimals);

/// The edits that put `values` in the place of a target's numbers. Lengths, rotation and joints have the most digits behind the point
/// that one of their group has in this target; in languages that leave the digits to the writer at least those that a micrometre at
/// an arm's length asks for. FANUC keeps the columns. VAL3 writes an attribute that was left out for zero, if it is zero no more.
std::vector<Edit> number_edits(std::string_view text, ProgramLanguage language, const ProgramTarget& target, const std::vector<double>& values);

/// What the written numbers then are: `values` rounded.
std::vector<double> rounded(std::string_view text, ProgramLanguage language, const ProgramTarget& target, const std::vector<double>& values);

}  // namespace mdhcal::offline
