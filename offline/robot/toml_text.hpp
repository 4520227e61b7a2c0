// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace mdhcal::offline {

/// toml++'s parser met what it takes for impossible: throws ParserAssertion.
[[noreturn]] void fail_assertion();
struct ParserAssertion {};

}  // namespace mdhcal::offline

// toml++ 3.3 asserts, and in a release build assumes, what some malformed texts break (found by fuzzing: a table header
// without a name, a closing bracket of the other kind). Here its assertions are kept, and are exceptions. Every file of
// the project includes it from here, so that there is one definition of its inline functions.
#pragma push_macro("NDEBUG")
#undef NDEBUG
#define TOML_ASSERT(condition) ((condition) ? void() : ::mdhcal::offline::fail_assertion())
#include <toml++/toml.h>
#pragma pop_macro("NDEBUG")

namespace mdhcal::offline {

/// Reads TOML. Throws InputError naming `path`, line and column where the text is none. A character outside ASCII anywhere
/// but in strings and comments is refused before toml++ sees it, which is undefined there
/// (is_unicode_horizontal_whitespace() runs into its TOML_UNREACHABLE, found by fuzzing).
toml::table parse_toml(const std::string& text, const std::string& path);

}  // namespace mdhcal::offline
