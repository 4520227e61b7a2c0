// SPDX-License-Identifier: MIT
// What the program says to people: on stderr, so that data on stdout stays data.
#pragma once

#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>

namespace mdhcal::offline {

/// How much the program says.
enum class Verbosity : std::int32_t {
  quiet,    ///< errors only
  normal,
  verbose,  ///< also what was decided and why
};

void set_verbosity(Verbosity verbosity);
Verbosity verbosity();

/// A line on stderr, unless --quiet.
void inform(const std::string& message);
/// A line on stderr under --verbose.
void detail(const std::string& message);
/// A line on stderr that begins with "warning:", unless --quiet.
void warn(const std::string& message);
/// The one line about why the program stops: always.
void complain(const std::string& message);

/// The colours that tables and messages use.
enum class Colour : std::int32_t { bold, green, yellow, red };

/// Whether `stream` takes colour: it is a terminal, TERM is not "dumb" and NO_COLOR is not set (https://no-color.org).
bool takes_colour(std::FILE* stream);
/// The text in a colour if `stream` takes it, else the text.
std::string coloured(std::string_view text, Colour colour, std::FILE* stream);

}  // namespace mdhcal::offline
