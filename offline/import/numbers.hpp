// SPDX-License-Identifier: MIT
// Numbers and times as people's programs write them.
#pragma once

#include <optional>
#include <string_view>

namespace mdhcal::offline {

/// A finite number with the decimal separator `decimal` ('.' or ','). Digits before it may stand in complete groups of
/// three, parted by the other of the two, a blank or an apostrophe: "2,140.2250", "2.140,2250". Nothing if it is none.
std::optional<double> parse_number(std::string_view text, char decimal);

/// Whether the text is a number with one of the two separators.
bool may_be_number(std::string_view text);

/// Seconds: a plain number; "yyyy-mm-dd hh:mm:ss.fff" (or with T, and Z behind it); "dd.mm.yyyy hh:mm:ss.fff";
/// "mm/dd/yyyy hh:mm:ss" or "dd/mm/yyyy ..." (month first where both can be); "hh:mm:ss.fff". Dates count from
/// 1970-01-01 without regard to time zones. A leading apostrophe is skipped. Nothing if it is none.
std::optional<double> parse_time(std::string_view text, char decimal);

}  // namespace mdhcal::offline
