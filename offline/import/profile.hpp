// SPDX-License-Identifier: MIT
// How a layout is read: what a small TOML file says that the table itself does not.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace mdhcal::offline {

/// Every key is optional; what is not stated is told from the table, or asked.
struct Profile {
  std::string name;                    ///< the file's name without ".toml"
  std::string about;                   ///< what writes this layout
  std::vector<std::string> recognise;  ///< patterns with '*': each fits one of the first 40 lines of a file in this layout
  std::string encoding;                ///< "utf-8", "utf-16", "latin-1"
  char delimiter = 0;                  ///< comma, semicolon, tab or blank (key: "," ";" "tab" "space")
  char decimal = 0;                    ///< '.' or ','
  std::size_t skip_lines = 0;          ///< lines before the table
  /// Meanings of the columns by position (meaning.hpp), "-" for one that is not used; no header is looked for.
  std::vector<std::string> columns;
  /// [rename]: meaning -> pattern with '*' of the column's name in the header, first fit.
  std::map<std::string, std::string> rename;
  std::string names;                   ///< what point names are made of: "{collection}::{id}::{target}"
  std::string rotation;                ///< convention of three angles or four numbers (measure/rotations.hpp), or "none"
  std::string length_unit, angle_unit, joint_unit;  ///< of columns that do not state one: mm, m, um, in; deg, rad
  double coverage = 2;                 ///< k of expanded uncertainties: standard deviation = U / k
  std::vector<std::string> targets;    ///< names of the points of a row, or of the files, in order
  std::vector<std::string> joints;     ///< the joints' column names, joint 1 first
};

/// Reads a profile. Throws InputError naming file, line and column: unknown key, wrong kind of value, unknown unit.
Profile parse_profile(const std::string& text, const std::string& path, const std::string& name);

/// A built-in profile by its name, else the file `name`. Throws InputError with the list of names if it is neither.
Profile find_profile(const std::string& name);

/// The names of the built-in profiles.
std::vector<std::string> profile_names();

/// The built-in profile whose patterns fit these lines; the one with the most patterns if several do; nothing if none.
std::optional<Profile> recognised_profile(const std::vector<std::string_view>& lines);

/// Whether `text` fits a pattern in which '*' stands for any characters; small and capital letters are the same.
bool fits(std::string_view text, std::string_view pattern);

}  // namespace mdhcal::offline
